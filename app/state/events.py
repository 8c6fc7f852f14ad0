"""What can happen to the state: one type for each kind of event."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import msgspec

from app.state.model import Advice, Landscape, Notice, Question, Result, Source, Upload, Work
from app.state.setup import Setup
from app.state.study import StudyEvent
from app.storage import Stamp
from fuzzy.finding import Finding
from fuzzy.system import FuzzySystem


class Edit(msgspec.Struct, frozen=True):
    """Change the document by a pure function; edits of one gesture merge into one step of the history."""

    label: str
    change: Callable[[FuzzySystem], FuzzySystem]
    gesture: str = ""
    at: float = 0.0


class Undo(msgspec.Struct, frozen=True):
    """Take back the last step."""


class Redo(msgspec.Struct, frozen=True):
    """Do again what was taken back last."""


class JumpedTo(msgspec.Struct, frozen=True):
    """Take back so many of the last steps, or do so many again where ``steps`` is positive."""

    steps: int


class Opened(msgspec.Struct, frozen=True):
    """A file was read. That can be undone too, so that no unsaved document is ever lost."""

    document: FuzzySystem
    file: str
    stamp: Stamp
    files: tuple[str, ...]


class Uploaded(msgspec.Struct, frozen=True):
    """A browser brought a document; None takes it back."""

    upload: Upload | None


class Imported(msgspec.Struct, frozen=True):
    """The uploaded document takes the place of the present one, which can be undone; it is in no file yet."""


class Begun(msgspec.Struct, frozen=True):
    """A new document takes the place of the present one, which can be undone; it is in no file yet."""

    document: FuzzySystem


class Saved(msgspec.Struct, frozen=True):
    """A document was written to a file; it may have been edited since.

    ``origin`` is where the document was kept when saving began: another file may have been opened since.
    """

    document: FuzzySystem
    file: str
    stamp: Stamp
    files: tuple[str, ...]
    origin: Source | None = None


class Recovered(msgspec.Struct, frozen=True):
    """Go on with the work of a session that crashed. What is open now stays in the history, if it was edited."""

    work: Work


class Asked(msgspec.Struct, frozen=True):
    """Put a question to the user; None takes it back."""

    question: Question | None


class Selected(msgspec.Struct, frozen=True):
    """Change selections of the session, by name."""

    changes: dict[str, Any]


class DesignChanged(msgspec.Struct, frozen=True):
    """Change selections of the Design panel, by name."""

    changes: dict[str, Any]


class SetupChanged(msgspec.Struct, frozen=True):
    """Change the experiment, by name."""

    changes: dict[str, Any]


class PlaybackChanged(msgspec.Struct, frozen=True):
    """Change how time passes, by name."""

    changes: dict[str, Any]


class ResetRequested(msgspec.Struct, frozen=True):
    """Begin the live simulation or the replay anew."""


class RunKept(msgspec.Struct, frozen=True):
    """Keep the present run to compare with."""


class KeptRenamed(msgspec.Struct, frozen=True):
    """Give the kept run of a slot another name."""

    slot: int
    name: str


class KeptRemoved(msgspec.Struct, frozen=True):
    """Forget the kept run of a slot."""

    slot: int


class RunFinished(msgspec.Struct, frozen=True, eq=False):
    """A whole scenario was simulated for ``document`` and ``setup``."""

    document: FuzzySystem
    setup: Setup
    result: Result
    pid: Result
    findings: tuple[Finding, ...] = ()


class SurfaceFound(msgspec.Struct, frozen=True, eq=False):
    """The control surface of ``document`` was computed; None where it has none."""

    document: FuzzySystem
    landscape: Landscape | None


class Advised(msgspec.Struct, frozen=True, eq=False):
    """It was found out what to look at where ``result`` overshoots."""

    result: Result
    advice: tuple[Advice, ...]


class Progressed(msgspec.Struct, frozen=True):
    """Kernels are being made ready: what is done now; None when they are."""

    text: str | None


class Noticed(msgspec.Struct, frozen=True):
    """Tell the user something."""

    notice: Notice | None


Event = (
    Edit
    | Undo
    | Redo
    | JumpedTo
    | Opened
    | Uploaded
    | Imported
    | Begun
    | Saved
    | Recovered
    | Asked
    | Selected
    | DesignChanged
    | SetupChanged
    | PlaybackChanged
    | ResetRequested
    | RunKept
    | KeptRenamed
    | KeptRemoved
    | RunFinished
    | SurfaceFound
    | Advised
    | Progressed
    | Noticed
    | StudyEvent
)
