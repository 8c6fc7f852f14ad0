"""What the workbench shows, as one immutable value, and the pure function that changes it.

Three kinds of state are kept apart. The *document* is undone, redone and saved. The *session* (selections, the
running experiment, notices) is neither. A *frame* of the moving arm never comes here: see :mod:`app.runner`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal, NamedTuple, assert_never

import msgspec

from app.storage import Stamp
from fuzzy.check import Finding
from fuzzy.errors import FuzzyError
from fuzzy.system import FuzzySystem
from robot.metrics import Metrics
from robot.simulation import Run

HISTORY_LENGTH = 200
"""Steps that can be undone."""

GESTURE_SECONDS = 1.0
"""Edits of one gesture that follow each other faster are undone together."""

DragMode = Literal["partition", "free"]
PlaybackSource = Literal["live", "replay"]
SPEEDS = (0.1, 0.5, 1.0, 2.0, 5.0)


class Source(msgspec.Struct, frozen=True):
    """Where a document is kept: what was last read or saved, the file's name, and what that looked like on disk."""

    saved: FuzzySystem
    file: str | None = None
    stamp: Stamp | None = None


class Step(msgspec.Struct, frozen=True):
    """One step of the history: the document before it, what was done, and the gesture that it belongs to.

    ``source`` is set where the step changed the file too: who undoes it and saves must not overwrite the other file.
    """

    document: FuzzySystem
    label: str
    gesture: str = ""
    at: float = 0.0
    source: Source | None = None


class Setup(msgspec.Struct, frozen=True):
    """The experiment: which arm, under which control law, has to do what. Names are those of :mod:`robot`."""

    arm: str = "soft"
    controller: str = "fuzzy_flc"
    scenario: str = "step"
    disturbance: str = "none"
    natural_frequency: float | None = None  # rad/s; None is what the scenario asks for


class Playback(msgspec.Struct, frozen=True):
    """How time passes: the live simulation, or the finished run from ``time`` (s) on."""

    source: PlaybackSource = "live"
    is_playing: bool = True
    speed: float = 1.0
    time: float = 0.0
    resets: int = 0  # counts the wishes to begin anew


class Notice(msgspec.Struct, frozen=True):
    """A sentence for the user."""

    text: str
    is_error: bool = False


class Result(NamedTuple):
    """A whole simulated scenario and its figures of merit."""

    run: Run
    metrics: Metrics


class Runs(msgspec.Struct, frozen=True, eq=False):
    """Whole simulated scenarios: with the present document, before the last edit, and under plain PID control."""

    current: Result | None = None
    before: Result | None = None
    pid: Result | None = None


class AppState(msgspec.Struct, frozen=True, eq=False):
    """All that the views are rendered from."""

    document: FuzzySystem
    source: Source
    files: tuple[str, ...] = ()
    new_name: str = ""
    past: tuple[Step, ...] = ()
    future: tuple[Step, ...] = ()
    brush: str | None = None
    variable: str = ""
    term: str = ""
    drag: DragMode = "partition"
    coordinate: int = 0
    setup: Setup = Setup()
    playback: Playback = Playback()
    runs: Runs = Runs()
    findings: tuple[Finding, ...] = ()
    progress: str | None = "starting"
    notice: Notice | None = None

    @property
    def file(self) -> str | None:
        """Name of the file that the document is kept in."""
        return self.source.file

    @property
    def is_unsaved(self) -> bool:
        """Whether the document differs from the file."""
        return self.document != self.source.saved


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


class Opened(msgspec.Struct, frozen=True):
    """A file was read. That can be undone too, so that no unsaved document is ever lost."""

    document: FuzzySystem
    file: str
    stamp: Stamp
    files: tuple[str, ...]


class Saved(msgspec.Struct, frozen=True):
    """A document was written to a file; it may have been edited since."""

    document: FuzzySystem
    file: str
    stamp: Stamp
    files: tuple[str, ...]


class Selected(msgspec.Struct, frozen=True):
    """Change selections of the session, by name."""

    changes: dict[str, Any]


class SetupChanged(msgspec.Struct, frozen=True):
    """Change the experiment, by name."""

    changes: dict[str, Any]


class PlaybackChanged(msgspec.Struct, frozen=True):
    """Change how time passes, by name."""

    changes: dict[str, Any]


class ResetRequested(msgspec.Struct, frozen=True):
    """Begin the live simulation or the replay anew."""


class RunFinished(msgspec.Struct, frozen=True, eq=False):
    """A whole scenario was simulated for ``document`` and ``setup``."""

    document: FuzzySystem
    setup: Setup
    result: Result
    pid: Result
    findings: tuple[Finding, ...] = ()


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
    | Opened
    | Saved
    | Selected
    | SetupChanged
    | PlaybackChanged
    | ResetRequested
    | RunFinished
    | Progressed
    | Noticed
)

_replace = msgspec.structs.replace


def initial(
    document: FuzzySystem, *, file: str | None = None, stamp: Stamp | None = None, files: tuple[str, ...] = ()
) -> AppState:
    """Return the state in which the workbench opens with a document."""
    table = document.rules.table
    output = next((variable for variable in document.outputs if table and variable.name == table.output), None)
    brush = output.terms[-1].name if output else None
    state = AppState(document=document, source=Source(document, file, stamp), files=files, brush=brush)
    return _with_valid_selection(state)


def update(state: AppState, event: Event) -> AppState:  # noqa: C901
    """Return the state after an event. Pure: no clock, no files, no widgets; a refused edit leaves a notice."""
    match event:
        case Edit():
            return _edited(state, event)
        case Undo():
            return _undone(state)
        case Redo():
            return _redone(state)
        case Opened():
            step = Step(state.document, f"open {event.file}", source=state.source)
            opened = _changed(state, event.document, (*state.past, step), ())
            source = Source(event.document, event.file, event.stamp)
            return _replace(opened, source=source, files=event.files, notice=None)
        case Saved():
            source = Source(event.document, event.file, event.stamp)
            return _replace(state, source=source, files=event.files, notice=Notice(f"Saved {event.file}."))
        case Selected():
            return _with_valid_selection(_replace(state, **event.changes))
        case SetupChanged():
            # Another disturbance asks for another bandwidth; one that was chosen by hand was chosen for the old one.
            reset = {"natural_frequency": None} if "disturbance" in event.changes else {}
            setup = _replace(state.setup, **(reset | event.changes))
            # The runs before belong to another experiment: nothing to compare with.
            return _replace(state, setup=setup, runs=_replace(state.runs, before=None))
        case PlaybackChanged():
            return _replace(state, playback=_replace(state.playback, **event.changes))
        case ResetRequested():
            playback = state.playback
            return _replace(state, playback=_replace(playback, time=0.0, resets=playback.resets + 1))
        case RunFinished():
            if event.setup != state.setup:
                return state
            runs = _replace(state.runs, current=event.result, pid=event.pid)
            return _replace(state, runs=runs, findings=event.findings)
        case Progressed():
            return _replace(state, progress=event.text)
        case Noticed():
            return _replace(state, notice=event.notice)
        case _:
            assert_never(event)


def _edited(state: AppState, event: Edit) -> AppState:
    try:
        document = event.change(state.document)
    except FuzzyError as error:
        return _replace(state, notice=Notice(f"Not done: {error}.", is_error=True))
    if document == state.document:
        return _replace(state, notice=None)
    last = state.past[-1] if state.past else None
    if last and event.gesture and last.gesture == event.gesture and event.at - last.at < GESTURE_SECONDS:
        past = (*state.past[:-1], _replace(last, label=event.label, at=event.at))
        merged = _replace(state, document=document, past=past, future=(), notice=None)
        return _with_valid_selection(merged)
    step = Step(state.document, event.label, event.gesture, event.at)
    return _replace(_changed(state, document, (*state.past, step), ()), notice=None)


def _undone(state: AppState) -> AppState:
    if not state.past:
        return _replace(state, notice=Notice("Nothing to undo."))
    step = state.past[-1]
    future = (_opposite(state, step), *state.future)
    undone = _changed(state, step.document, state.past[:-1], future)
    return _replace(undone, source=step.source or state.source, notice=Notice(f"Undone: {step.label}."))


def _redone(state: AppState) -> AppState:
    if not state.future:
        return _replace(state, notice=Notice("Nothing to redo."))
    step = state.future[0]
    past = (*state.past, _opposite(state, step))
    redone = _changed(state, step.document, past, state.future[1:])
    return _replace(redone, source=step.source or state.source, notice=Notice(f"Done again: {step.label}."))


def _opposite(state: AppState, step: Step) -> Step:
    """Return the step that leads back from where ``step`` leads."""
    return Step(state.document, step.label, source=state.source if step.source else None)


def _changed(state: AppState, document: FuzzySystem, past: tuple[Step, ...], future: tuple[Step, ...]) -> AppState:
    """Return the state with another document; the run so far becomes the one to compare with."""
    runs = _replace(state.runs, before=state.runs.current)
    changed = _replace(state, document=document, past=past[-HISTORY_LENGTH:], future=future, runs=runs)
    return _with_valid_selection(changed)


def _with_valid_selection(state: AppState) -> AppState:
    """Return the state with selections that exist in the document, the nearest where one is gone."""
    document = state.document
    variables = {variable.name: variable for variable in (*document.inputs, *document.outputs)}
    variable = state.variable if state.variable in variables else document.inputs[0].name
    terms = [term.name for term in variables[variable].terms]
    term = state.term if state.term in terms else terms[len(terms) // 2]
    table = document.rules.table
    # Without a table there is nothing to paint: the brush waits for the next document with one.
    brushes = [t.name for t in variables[table.output].terms] if table else [state.brush]
    brush = state.brush if state.brush is None or state.brush in brushes else brushes[-1]
    if (variable, term, brush) == (state.variable, state.term, state.brush):
        return state
    return _replace(state, variable=variable, term=term, brush=brush)
