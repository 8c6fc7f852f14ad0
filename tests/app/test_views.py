"""The views on a real viser server, without a browser: cheap renders, no leaks, any document, hostile input."""

from __future__ import annotations

import asyncio
import itertools
import math
import re
from collections.abc import Callable, Coroutine, Iterator
from functools import partial
from pathlib import Path
from typing import Any, TypeVar, cast

import msgspec
import numpy as np
import pytest
import viser
from hypothesis import given, settings
from viser import _messages

import fuzzy
from app import experiment, guard
from app.filing import Filing
from app.runner import Frame
from app.scene.scene import Scene
from app.state import (
    AppState,
    Edit,
    Notice,
    Noticed,
    Opened,
    Progressed,
    Result,
    RunFinished,
    Selected,
    Setup,
    Undo,
    initial,
)
from app.storage import Stamp, Storage
from app.store import Store
from app.views.files import FilesView
from app.views.inference import ExplainView, InferenceView
from app.views.membership import MembershipView
from app.views.rules import RulesView
from app.views.run import RunPanels
from fuzzy import edits
from fuzzy.errors import InvalidInputError
from fuzzy.formats import load, save
from fuzzy.shapes import Gaussian, Triangle
from fuzzy.system import FuzzySystem, Input, Is, NoFire, Output, Rule, RuleBase, RuleTable, Sampling, Term
from robot.arm import Arm
from robot.controllers import FuzzyFlc
from robot.errors import RobotError
from robot.pull import Pull
from robot.run import Run
from robot.simulation import simulate
from tests import strategies

RULEBASES = Path(__file__).parents[2] / "rulebases"
DIAGONAL = load(RULEBASES / "diagonal.yaml")
PILTAN = load(RULEBASES / "piltan.yaml")
STAMP = Stamp(1, 2, "3")
replace = msgspec.structs.replace

Returned = TypeVar("Returned")


class Screen:
    """All views over one server, driven as the workbench and a browser drive them."""

    def __init__(
        self, server: viser.ViserServer, folder: Path, document: FuzzySystem, *, turn_seconds: float = math.inf
    ) -> None:
        self.server = server
        self.loop = server.get_event_loop()
        self.sent: list[_messages.Message] = []
        interface: Any = server._websock_server
        real = interface.queue_message

        def queue_message(message: _messages.Message) -> None:
            self.sent.append(message)
            real(message)

        interface.queue_message = queue_message
        cast("Any", server.gui)._resolve_client = lambda _: object()  # a client that is there
        state = initial(document, file="mine.yaml", stamp=STAMP, files=("mine.yaml",))
        self.store = Store(state, self.loop, turn_seconds=turn_seconds)
        self.on_loop(lambda: self._build(Storage(folder)))

    def _build(self, storage: Storage) -> None:
        gui, store, filing = self.server.gui, self.store, Filing(storage, lambda: self.store.state)
        run = RunPanels(gui, store)
        rules, membership, explanation = RulesView(gui, store), MembershipView(gui, store), ExplainView(gui, store)
        self.pulls: list[Pull | None] = []
        self.live_views: list[Any] = [rules, membership, explanation, *run.live_views]
        inference, files = InferenceView(gui, store), FilesView(gui, store, filing)
        self.scene = Scene(self.server, store, self.pulls.append)
        self.views: list[Any] = [*rules.views, *membership.views, explanation, *inference.views, *files.views]
        self.views += [*run.views, *self.scene.views]
        self.store.add(*self.views)

    def on_loop(self, do: Callable[[], Returned]) -> Returned:
        async def run() -> Returned:
            return do()

        return asyncio.run_coroutine_threadsafe(run(), self.loop).result(60)

    def in_turns(self, work: Callable[[], Coroutine[Any, Any, None]]) -> None:
        """Do some work on the loop while each view waits for a turn of its own, until all have had theirs."""

        async def run() -> None:
            await work()
            while self.store._stale:  # noqa: ASYNC110
                await asyncio.sleep(0)

        self.store._turn_seconds = 0.0
        try:
            asyncio.run_coroutine_threadsafe(run(), self.loop).result(60)
        finally:
            self.store._turn_seconds = math.inf

    def dispatch(self, *events: Any) -> AppState:
        for event in events:
            self.on_loop(lambda event=event: self.store.dispatch(event))
        return self.store.state

    def open(self, document: FuzzySystem) -> AppState:
        return self.dispatch(Opened(document, "other.yaml", STAMP, ("mine.yaml", "other.yaml")))

    def show(self, frame: Frame) -> None:
        for view in [*self.live_views, self.scene]:
            self.on_loop(lambda view=view: view.show(frame))

    def handles(self) -> dict[str, Any]:
        return self.server.gui._gui_input_handle_from_uuid

    def view(self, name: str) -> Any:
        """Return the view of a class."""
        return next(view for view in self.views if type(view).__name__ == name)

    def find(self, label: str) -> Any:
        """Return the input with a label."""
        found = [handle for handle in self.handles().values() if handle._impl.props.label == label]
        assert len(found) == 1, f"{label}: {[handle._impl.props.label for handle in self.handles().values()]}"
        return found[0]

    def send(self, handle: Any, value: object) -> AppState:
        """Do what a browser does that changes a widget, or presses a button."""
        message = _messages.GuiUpdateMessage(handle._impl.uuid, {"value": value})
        updating = self.server.gui._handle_gui_updates(cast("Any", 0), message)
        asyncio.run_coroutine_threadsafe(updating, self.loop).result(60)
        return self.store.state

    def html(self) -> str:
        """Return all HTML that was sent since the last look."""
        sent, self.sent[:] = list(self.sent), []
        found = []
        for message in sent:
            if isinstance(message, _messages.GuiHtmlMessage):
                found.append(message.props.content)
            elif isinstance(message, _messages.GuiUpdateMessage):
                found.append(str(message.updates.get("content", "")))
        return "".join(found)


@pytest.fixture
def screen(tmp_path: Path) -> Iterator[Screen]:
    save(DIAGONAL, tmp_path / "mine.yaml")
    server = guard.start_server(port=0)
    yield Screen(server, tmp_path, DIAGONAL)
    server.stop()


@pytest.fixture(scope="module")
def run() -> Run:
    return simulated(DIAGONAL)


def simulated(document: FuzzySystem, setup: Setup = Setup()) -> Run:  # noqa: B008
    wanted = experiment.prepare(setup, fuzzy.compile_system(document))
    return simulate(wanted.arm, wanted.law, replace(wanted.scenario, duration=0.5))


def finished(document: FuzzySystem, setup: Setup = Setup()) -> RunFinished:  # noqa: B008
    found = simulated(document, setup)
    result = Result(found, found.metrics(), found.thinned(100))
    return RunFinished(document, setup, result, result, tuple(fuzzy.check(document)))


def frame_of(run: Run, row: int, strength: np.ndarray | None) -> Frame:
    inference = run.controller.inference if isinstance(run.controller, FuzzyFlc) and strength is not None else None
    return Frame(
        arm=run.arm,
        t=float(run.t[row]),
        q=run.q[row],
        target=run.reference[row],
        forces=run.forces[row],
        inputs=run.inputs[row, 0],
        inference=inference,
        strength=strength,
        factor=1.0,
        stopped=None,
        blocks=run.inputs[row],
        outputs=run.output[row],
    )


def strengths(document: FuzzySystem, run: Run, row: int) -> np.ndarray | None:
    try:
        return fuzzy.compile_system(document).explain(*run.inputs[row, 0]).strength
    except InvalidInputError:
        return None


# Cost


def test_rendering_what_is_shown_already_sends_nothing(screen: Screen) -> None:
    state = screen.dispatch(finished(DIAGONAL), Selected({"variable": "T"}), Selected({"brush": None}))
    screen.sent.clear()
    for _ in range(3):
        for view in screen.views:
            screen.on_loop(partial(view.render, state))
    assert screen.sent == []


def test_an_edit_sends_what_it_changes_and_only_that(screen: Screen) -> None:
    screen.dispatch(finished(DIAGONAL))
    screen.sent.clear()
    screen.dispatch(Edit("paint", partial(edits.set_cell, row=0, column=0, consequent="LR")))
    updated = {message.uuid for message in screen.sent if isinstance(message, _messages.GuiUpdateMessage)}
    assert 0 < len(updated) <= 8  # the legends name the run before from now on
    assert len(screen.sent) <= 12


def test_a_hundred_edits_leave_as_many_widgets_as_before(screen: Screen) -> None:
    def cycle() -> None:
        screen.dispatch(
            Selected({"variable": "de", "term": "Z"}),
            Edit("gauss", partial(edits.set_shape_kind, variable="de", term="Z", kind="gaussian")),
            Selected({"drag": "free"}),
            Edit("range", partial(edits.set_range, variable="de", low=-9.0, high=9.0)),
            Edit("term", partial(edits.add_term, variable="e", name="more", shape=Triangle(0.8, 1.0, 1.2))),
            Edit("paint", partial(edits.set_cell, row=7, column=0, consequent="LR")),
            Selected({"drag": "partition"}),
            *([Undo()] * 4),
            Selected({"variable": "e", "term": "PS"}),
        )

    def count() -> tuple[int, ...]:
        gui = cast("Any", screen.server.gui)
        screen.on_loop(lambda: screen.server._run_garbage_collector(force=True))
        return (len(screen.handles()), len(gui._container_handle_from_uuid), len(buffered(screen)))

    cycle()
    first = count()
    for _ in range(20):
        cycle()
    assert screen.store.state.document == DIAGONAL
    inputs, containers, messages = count()
    assert (inputs, containers) == first[:2]
    assert messages <= first[2] + 20, "what a browser gets that connects later must not grow with every edit"


def buffered(screen: Screen) -> list[Any]:
    """Return what a browser that connects now would get."""
    buffer: Any = screen.server._websock_server.get_message_buffer()
    return list(buffer.message_from_id.values())


def test_frames_update_the_scene_in_place(screen: Screen, run: Run) -> None:
    screen.dispatch(finished(DIAGONAL))
    for row in (0, 100):
        screen.show(frame_of(run, row, strengths(DIAGONAL, run, row)))
    screen.sent.clear()
    screen.show(frame_of(run, 200, strengths(DIAGONAL, run, 200)))
    kinds = {type(message) for message in screen.sent}
    assert kinds <= {_messages.GuiUpdateMessage, _messages.SceneNodeUpdateMessage}
    assert len(screen.sent) < 40


# What a browser may send


def test_a_refused_value_is_taken_back_and_said(screen: Screen) -> None:
    number = screen.find("range")
    for value in (float("nan"), float("inf"), -1e300, 5.0):
        state = screen.send(number, (value, 1.0))
        assert state.document is DIAGONAL
        assert state.notice is not None
        assert state.notice.is_error
        assert number.value == (-1.0, 1.0)


def test_what_went_wrong_is_said_while_something_is_under_way(screen: Screen) -> None:
    screen.dispatch(Progressed("Compiling kernels"), Noticed(Notice("Not read: broken.yaml", is_error=True)))
    shown = screen.view("PlaybackView")._notice.content
    assert "Compiling kernels" in shown
    assert "Not read: broken.yaml" in shown


def test_there_is_nothing_to_explain_before_the_first_run(screen: Screen, run: Run) -> None:
    screen.show(frame_of(run, 0, None))
    assert "first run" in screen.view("WhyView")._now.content
    screen.dispatch(finished(DIAGONAL, Setup()))
    screen.on_loop(lambda: setattr(screen.view("WhyView"), "_shown_at", 0.0))
    screen.show(frame_of(run, 0, None))
    assert "This law asks no rules" in screen.view("WhyView")._now.content


@pytest.mark.parametrize(
    ("inputs", "said"),
    [
        ((3.1, -17.6), "the one rule that fires says so"),  # PB and FL -> Z
        ((1 / 6, -1.0), "the rules that fire hold each other"),
        ((0.2, 0.5), "raises it, mostly because"),
        ((-0.2, -0.5), "lowers it, mostly because"),
    ],
)
def test_why_says_what_the_rules_that_fire_do(screen: Screen, run: Run, inputs: tuple[float, float], said: str) -> None:
    frame = frame_of(run, 0, strengths(DIAGONAL, run, 0))
    frame = frame._replace(inference=fuzzy.compile_system(DIAGONAL), inputs=np.array(inputs))
    screen.on_loop(lambda: setattr(screen.view("WhyView"), "_shown_at", 0.0))
    screen.show(frame)
    assert said in screen.view("WhyView")._now.content


@pytest.mark.parametrize(
    ("label", "value"),
    [
        ("composition", "Max-Nonsense"),
        ("implication", "eval"),
        ("T if no rule", "explode"),
        ("e out of range", "bounce"),
        ("samples", "all of them"),
        ("points", 1),
        ("shape", "heap"),
        ("scenario", "war"),
        ("controller", "__class__"),
        ("speed", "1000×"),
        ("source", ""),
        ("open", "../../etc/passwd"),
        ("t [s]", 1e9),
        ("t [s]", float("nan")),
        ("new name", "x" * 1000),
        ("notes", "x" * 30_000),
        ("notes", "bell \x07"),
        ("T default", float("nan")),
    ],
)
def test_what_is_not_offered_is_refused(screen: Screen, run: Run, label: str, value: object) -> None:
    handle = screen.find(label)
    screen.show(frame_of(run, 0, None))
    shown, before = handle.value, screen.store.state
    state = screen.send(handle, value)
    assert state.document is before.document
    assert (state.setup, state.playback, state.drag) == (before.setup, before.playback, before.drag)
    assert state.notice is not None
    assert state.notice.is_error
    screen.show(frame_of(run, 0, None))
    assert handle.value == shown


@pytest.mark.parametrize(
    ("label", "valid"),
    [("pattern", "clear"), ("file", "save"), ("history", "undo"), ("drag", "free"), ("variable", "T"), ("term", "NB")],
)
def test_a_button_group_takes_its_own_buttons_only(screen: Screen, label: str, valid: str) -> None:
    handle = screen.find(label)
    state = screen.send(handle, "no such button")
    assert state.document is DIAGONAL
    assert (state.variable, state.term) == ("e", "Z")
    screen.send(handle, valid)
    assert screen.store.state is not state


def test_opening_and_saving_go_through_the_folder(screen: Screen, tmp_path: Path) -> None:
    screen.dispatch(Edit("paint", partial(edits.set_cell, row=0, column=0, consequent="LR")))
    screen.send(screen.find("new name"), "copy")
    state = screen.send(screen.find("Save under the new name"), True)
    assert (state.file, state.is_unsaved) == ("copy.yaml", False)
    assert load(tmp_path / "copy.yaml") == state.document
    assert load(tmp_path / "mine.yaml") == DIAGONAL
    state = screen.send(screen.find("open"), "mine.yaml")
    assert (state.document, state.file) == (DIAGONAL, "mine.yaml")
    screen.send(screen.find("new name"), "copy")
    refused = screen.send(screen.find("Save under the new name"), True)
    assert refused.notice is not None
    assert refused.notice.is_error, "there is a file of that name"


def test_painting_and_dragging_through_the_widgets(screen: Screen) -> None:
    screen.send(screen.find("brush LR"), True)
    state = screen.send(screen.find("NB, FL"), True)
    assert edits.rule_table(state.document).cells[0][0] == "LR"
    screen.send(screen.find("brush no rule"), True)
    state = screen.send(screen.find("NB, FL"), True)
    assert edits.rule_table(state.document).cells[0][0] is None
    slider = next(h for h in screen.handles().values() if isinstance(h, viser.GuiMultiSliderHandle))
    values = list(slider.value)
    values[4] -= 0.05
    state = screen.send(slider, values)
    shape = next(term.shape for term in state.document.inputs[0].terms if term.name == "PS")
    assert isinstance(shape, Triangle)
    assert shape.b == pytest.approx(values[4])


# Names


HOSTILE = (
    "<script>alert(1)</script>",
    '"><img src=x onerror=alert(1)>',
    "' onclick='x",
    "a & b </style>",
    "日本 ė θ̇ 😀",
)


def hostile(document: FuzzySystem) -> FuzzySystem:
    """Return a system whose names would be markup if they were not escaped."""
    names = itertools.cycle(HOSTILE)
    for variable in ("e", "de", "T"):
        terms = next(v.terms for v in (*document.inputs, *document.outputs) if v.name == variable)
        for n, term in enumerate(terms):
            document = edits.rename_term(document, variable, term.name, f"{n}{next(names)}")
    for n, variable in enumerate(("e", "de", "T")):
        document = edits.rename_variable(document, variable, HOSTILE[n])
    named = edits.set_notes(edits.set_name(document, HOSTILE[1]), HOSTILE[0])
    table = edits.rule_table(named)
    antecedent = Is(table.rows, named.inputs[0].terms[0].name)
    rule = Rule(antecedent, (Is(table.output, named.outputs[0].terms[-1].name),), 0.5)
    return replace(named, rules=RuleBase(table, (rule,)))


def test_names_are_text_never_markup(screen: Screen, run: Run) -> None:
    document = hostile(DIAGONAL)
    screen.sent.clear()
    screen.open(document)
    row = document.inputs[0].terms[0].name
    screen.dispatch(
        finished(document),
        Edit(f"paint {HOSTILE[0]}", partial(edits.set_cell, row=row, column=0, consequent=None)),
        Edit("refuse", partial(edits.set_cell, row=HOSTILE[0], column=0, consequent=HOSTILE[1])),
        Noticed(Notice(HOSTILE[1])),
    )
    for variable in (*document.inputs, *document.outputs):
        screen.dispatch(Selected({"variable": variable.name}))
        screen.show(frame_of(run, 60, strengths(document, run, 60)))
    html = screen.html()
    assert "&lt;script&gt;" in html
    assert "日本 ė θ̇ 😀" in html
    assert not re.search(r"<script|<img|</style>\s*[^<]*&lt;b", html)
    assert html.count("<style>") == html.count("</style>")
    for tag in re.findall(r"<[^>]*>", html):
        assert not re.search(r"\son\w+=", re.sub(r'"[^"]*"', "", tag)), tag


# Every kind of document


def with_gaussians(system: FuzzySystem) -> FuzzySystem:
    for variable in (*system.inputs, *system.outputs):
        for term in variable.terms:
            system = edits.set_shape_kind(system, variable.name, term.name, "gaussian")
    return edits.set_inference(system, resolution=Sampling(101, "midpoints"))


def three_inputs() -> FuzzySystem:
    third = Input("x", 0.0, 1.0, (Term("only", Gaussian(0.5, 0.1)),))
    return replace(DIAGONAL, inputs=(*DIAGONAL.inputs, third))


def one_term_each() -> FuzzySystem:
    terms = (Term("all", Triangle(0.0, 0.5, 1.0)),)
    return FuzzySystem(
        "small",
        (Input("a", 0.0, 1.0, terms), Input("b", 0.0, 1.0, terms)),
        (Output("c", 10.0, 20.0, (Term("high", Triangle(10.0, 15.0, 20.0)),), "N", NoFire("midpoint")),),
        RuleBase(RuleTable("a", "b", "c", (("high",),))),
    )


KINDS: dict[str, FuzzySystem] = {
    "piltan": PILTAN,
    "no table": replace(DIAGONAL, rules=RuleBase(None, (Rule(Is("e", "NB"), (Is("T", "LL"),)),))),
    "no rules at all": replace(DIAGONAL, rules=RuleBase()),
    "an empty table": edits.clear_table(DIAGONAL),
    "gaussians": with_gaussians(DIAGONAL),
    "three inputs": three_inputs(),
    "one input": replace(DIAGONAL, inputs=DIAGONAL.inputs[:1], rules=RuleBase()),
    "two outputs": replace(DIAGONAL, outputs=(*DIAGONAL.outputs, replace(DIAGONAL.outputs[0], name="U"))),
    "one term each": one_term_each(),
    "a transposed table": replace(
        PILTAN, rules=RuleBase(RuleTable("de", "e", "T", tuple(zip(*edits.rule_table(PILTAN).cells, strict=True))))
    ),
    "a table and a list": replace(
        DIAGONAL, rules=RuleBase(DIAGONAL.rules.table, (Rule(Is("e", "NB"), (Is("T", "LL"),), 0.5),))
    ),
    "hostile names": hostile(PILTAN),
    "inputs that stop the run": replace(
        DIAGONAL, inputs=tuple(replace(variable, out_of_range="reject") for variable in DIAGONAL.inputs)
    ),
    "another sampling": edits.set_inference(DIAGONAL, resolution=Sampling(37, "endpoints")),
}


def exercise(screen: Screen, document: FuzzySystem, run: Run) -> None:
    """Open a document, look at every variable and term in every mode, run it where it can, and show frames."""
    screen.open(document)
    # Until its own run is there, the frames are still those of the document before.
    screen.show(frame_of(run, 60, strengths(DIAGONAL, run, 60)))
    screen.show(frame_of(run, 61, None))
    for variable in (*document.inputs, *document.outputs):
        for term in variable.terms:
            for mode in ("free", "partition"):
                screen.dispatch(Selected({"variable": variable.name, "term": term.name, "drag": mode}))
        screen.show(frame_of(run, 62, strengths(DIAGONAL, run, 62)))
    try:
        event = finished(document)
    except RobotError:
        return
    screen.dispatch(event)
    own = event.result.run
    for row in (0, len(own.t) - 1) if len(own.t) else ():
        screen.show(frame_of(own, row, strengths(document, own, row)))
    for coordinate in range(2 * Arm.preset("soft").n_modules):
        screen.dispatch(Selected({"coordinate": coordinate}))


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_of_document_can_be_shown(screen: Screen, run: Run, kind: str) -> None:
    screen.dispatch(finished(DIAGONAL))
    document = KINDS[kind]
    exercise(screen, document, run)
    assert screen.store.state.document == document
    screen.dispatch(Undo())
    screen.show(frame_of(run, 60, strengths(DIAGONAL, run, 60)))
    assert screen.store.state.document == DIAGONAL


@pytest.fixture(scope="module")
def shared_screen(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Screen]:
    folder = tmp_path_factory.mktemp("shared")
    save(DIAGONAL, folder / "mine.yaml")
    server = guard.start_server(port=0)
    yield Screen(server, folder, DIAGONAL)
    server.stop()


@given(strategies.systems(name=strategies.names))
@settings(max_examples=40)
def test_any_system_can_be_shown(shared_screen: Screen, run: Run, document: FuzzySystem) -> None:
    exercise(shared_screen, document, run)
    assert shared_screen.store.state.document == document


def test_a_table_of_another_size_gets_as_many_buttons(screen: Screen) -> None:
    def cells() -> int:
        return sum(", " in handle._impl.props.label for handle in screen.handles().values())

    def brushes() -> int:
        return sum(handle._impl.props.label.startswith("brush ") for handle in screen.handles().values())

    assert (cells(), brushes()) == (49, 8)
    screen.open(one_term_each())
    assert (cells(), brushes()) == (1, 2)
    state = screen.send(screen.find("all, all"), True)
    screen.dispatch(Undo())
    screen.dispatch(Undo())
    assert (cells(), brushes()) == (49, 8)
    assert state.document != DIAGONAL


def test_buttons_are_named_after_the_terms_that_they_paint(screen: Screen) -> None:
    before = screen.find("NB, FL")
    screen.dispatch(Edit("rename", partial(edits.rename_term, variable="e", term="NB", name="far left")))
    assert screen.find("far left, FL") is before, "the keyboard's focus stays where it is"
    screen.send(screen.find("brush LR"), True)
    state = screen.send(screen.find("far left, FL"), True)
    assert edits.rule_table(state.document).cells[0][0] == "LR"
