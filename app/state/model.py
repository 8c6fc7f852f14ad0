"""The values that the state consists of: document with history, session, runs."""

from __future__ import annotations

from typing import Literal, NamedTuple, get_args

import msgspec
import numpy as np
from numpy.typing import NDArray

from app.state.design import Design
from app.state.setup import Setup
from app.state.study import Study
from app.storage import Stamp
from fuzzy.analysis import Surface
from fuzzy.finding import Finding
from fuzzy.system import FuzzySystem, Rule
from robot.metrics import Metrics
from robot.run import Run

DragMode = Literal["partition", "free"]
PlaybackSource = Literal["live", "replay"]
SPEEDS = (0.1, 0.25, 0.5, 1.0, 2.0, 5.0, 10.0)

MAX_KEPT = 4
"""Runs that can be kept to compare with."""

Chart = Literal["error", "output", "forces", "lyapunov"]
CHARTS: tuple[Chart, ...] = get_args(Chart)
"""Signals that are drawn below the response if wanted."""

Layer = Literal["target", "baselines", "trail", "gravity", "board", "surface"]
LAYERS: tuple[Layer, ...] = get_args(Layer)
"""Parts of the scene that can be hidden."""


class Source(msgspec.Struct, frozen=True):
    """Where a document is kept: what was last read or saved, the file's name, and what that looked like on disk.

    ``saved`` is None for a document that came from a browser and is in no file yet.
    """

    saved: FuzzySystem | None
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


class Upload(msgspec.Struct, frozen=True):
    """A document that came from a browser and may replace the present one.

    Attributes:
        name: Name of the file.
        document: What was read.
        remarks: What was left out or taken otherwise than it was written.
        findings: What the check says about it.
    """

    name: str
    document: FuzzySystem
    remarks: tuple[str, ...] = ()
    findings: tuple[str, ...] = ()


class Playback(msgspec.Struct, frozen=True):
    """How time passes: the live simulation, or the finished run from ``time`` (s) on."""

    source: PlaybackSource = "live"
    is_playing: bool = True
    loops: bool = True  # whether a scenario begins anew at its end
    speed: float = 1.0
    time: float = 0.0
    resets: int = 0  # counts the wishes to begin anew


class Notice(msgspec.Struct, frozen=True):
    """A sentence for the user."""

    text: str
    is_error: bool = False


class Result(NamedTuple):
    """A whole simulated scenario, its figures of merit, and what is drawn of it.

    Attributes:
        run: All rows.
        metrics: Its figures.
        drawn: As many rows as a chart has pixels.
        lyapunov: (n,) the law's Lyapunov function at these rows; None for a law for which none is known.
    """

    run: Run
    metrics: Metrics
    drawn: Run
    lyapunov: NDArray[np.float64] | None = None


class Advice(NamedTuple):
    """What to look at where a coordinate overshoots.

    Attributes:
        coordinate: Its number.
        percent: Overshoot, % of the step.
        start: From when on braking could have helped, s.
        peak: When the excess is largest, s.
        rule: The rule to look at; None if no rule fired.
        number: Its number, as in ``fuzzy.rules.all_rules``.
        push: How far it moved the output in the direction of the step, on the mean of that time.
        term: The neighbouring consequent with which it was tried; None if none helps.
        after: The overshoot then, %.
        settling: The worst settling time then, s.
    """

    coordinate: int
    percent: float
    start: float
    peak: float
    rule: Rule | None = None
    number: int = -1
    push: float = 0.0
    term: str | None = None
    after: float = 0.0
    settling: float = 0.0


class Kept(NamedTuple):
    """A run that was kept to compare with.

    Attributes:
        name: What the user calls it.
        slot: Number of its colour, from 0.
        result: The run.
        document: The system that it ran with.
        setup: The experiment that it was.
    """

    name: str
    slot: int
    result: Result
    document: FuzzySystem
    setup: Setup


class Landscape(NamedTuple):
    """A control surface, and its mesh in the scene as binary glTF."""

    surface: Surface
    mesh: bytes


class Runs(msgspec.Struct, frozen=True, eq=False):
    """Whole simulated scenarios: the present one, the one before the last edit, under plain PID control, and kept."""

    current: Result | None = None
    before: Result | None = None
    pid: Result | None = None
    kept: tuple[Kept, ...] = ()
    landscape: Landscape | None = None  # of the document that ran; None for more or fewer than two inputs
    advice: tuple[Advice, ...] | None = None  # on the present run; None while it is worked out


class AppState(msgspec.Struct, frozen=True, eq=False):
    """All that the views are rendered from."""

    document: FuzzySystem
    source: Source
    files: tuple[str, ...] = ()
    new_name: str = ""
    upload: Upload | None = None
    past: tuple[Step, ...] = ()
    future: tuple[Step, ...] = ()
    brush: str | None = None
    variable: str = ""
    term: str = ""
    drag: DragMode = "partition"
    design: Design = Design()
    coordinate: int = 0
    others: tuple[int, ...] = ()  # coordinates that are shown beside the chosen one
    charts: frozenset[Chart] = frozenset({"output"})
    hidden: frozenset[Layer] = frozenset()
    setup: Setup = Setup()
    playback: Playback = Playback()
    runs: Runs = Runs()
    study: Study = Study()
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
    def coordinates(self) -> tuple[int, ...]:
        """The coordinates that are shown, in their order."""
        return tuple(sorted({self.coordinate, *self.others}))

    @property
    def is_unsaved(self) -> bool:
        """Whether the document differs from the file."""
        return self.document != self.source.saved
