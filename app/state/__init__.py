"""What the workbench shows, as one immutable value, and the pure function that changes it.

Three kinds of state are kept apart. The *document* is undone, redone and saved. The *session* (selections, the
running experiment, notices) is neither. A *frame* of the moving arm never comes here: see :mod:`app.runner`.
"""

from app.state.design import Design
from app.state.events import (
    DesignChanged,
    Edit,
    Event,
    JumpedTo,
    Noticed,
    Opened,
    PlaybackChanged,
    Progressed,
    Redo,
    ResetRequested,
    RunFinished,
    Saved,
    Selected,
    SetupChanged,
    Undo,
)
from app.state.model import (
    SPEEDS,
    AppState,
    DragMode,
    Notice,
    Playback,
    PlaybackSource,
    Result,
    Runs,
    Setup,
    Source,
    Step,
)
from app.state.update import (
    GESTURE_SECONDS,
    HISTORY_LENGTH,
    initial,
    update,
)

__all__ = [
    "GESTURE_SECONDS",
    "HISTORY_LENGTH",
    "SPEEDS",
    "AppState",
    "Design",
    "DesignChanged",
    "DragMode",
    "Edit",
    "Event",
    "JumpedTo",
    "Notice",
    "Noticed",
    "Opened",
    "Playback",
    "PlaybackChanged",
    "PlaybackSource",
    "Progressed",
    "Redo",
    "ResetRequested",
    "Result",
    "RunFinished",
    "Runs",
    "Saved",
    "Selected",
    "Setup",
    "SetupChanged",
    "Source",
    "Step",
    "Undo",
    "initial",
    "update",
]
