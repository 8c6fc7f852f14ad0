"""The values that the state consists of: document with history, session, runs."""

from __future__ import annotations

from typing import Literal, NamedTuple

import msgspec

from app.state.design import Design
from app.storage import Stamp
from fuzzy.check import Finding
from fuzzy.system import FuzzySystem
from robot.metrics import Metrics
from robot.simulation import Run

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


class Work(msgspec.Struct, frozen=True):
    """What must not be lost: the document, its file, and the history."""

    document: FuzzySystem
    source: Source
    past: tuple[Step, ...] = ()
    future: tuple[Step, ...] = ()

    @property
    def is_unsaved(self) -> bool:
        """Whether a document is in no file: the present one, or one that was left by opening another file."""
        left = ((step.document, step.source) for step in (*self.past, *self.future) if step.source is not None)
        return any(document != source.saved for document, source in ((self.document, self.source), *left))


class Conflict(msgspec.Struct, frozen=True):
    """A question: the opened file was changed by somebody else and now looks like ``stamp``; whose version stays?"""

    file: str
    stamp: Stamp


class Recovery(msgspec.Struct, frozen=True):
    """A question: a session that crashed left ``work``, last written at ``at`` (s since 1970); go on with it?"""

    work: Work
    at: float
    journal: str


Question = Conflict | Recovery


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
    design: Design = Design()
    coordinate: int = 0
    setup: Setup = Setup()
    playback: Playback = Playback()
    runs: Runs = Runs()
    findings: tuple[Finding, ...] = ()
    progress: str | None = "starting"
    notice: Notice | None = None
    question: Question | None = None

    @property
    def work(self) -> Work:
        """What must not be lost."""
        return Work(self.document, self.source, self.past, self.future)

    @property
    def file(self) -> str | None:
        """Name of the file that the document is kept in."""
        return self.source.file

    @property
    def is_unsaved(self) -> bool:
        """Whether the document differs from the file."""
        return self.document != self.source.saved
