"""Events reach the page whole, at no greater cost than they must: what is rendered and sent, what stays behind."""

from __future__ import annotations

import asyncio
import dataclasses
import math
import threading
from collections.abc import Iterator
from functools import partial
from typing import Any, cast

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from viser import _messages

import fuzzy
from app import guard
from app.scene.landscape import landscape
from app.state import (
    CHARTS,
    LAYERS,
    Advised,
    AppState,
    Asked,
    Conflict,
    DesignChanged,
    Edit,
    Event,
    KeptRemoved,
    KeptRenamed,
    Notice,
    Noticed,
    Opened,
    PlaybackChanged,
    Progressed,
    Redo,
    ResetRequested,
    RunKept,
    Saved,
    Selected,
    Setup,
    SetupChanged,
    SurfaceFound,
    Undo,
    initial,
)
from app.store import Shown, Store
from fuzzy import analysis, edits
from fuzzy.finding import Finding
from fuzzy.formats import save
from fuzzy.language import parse_rule
from fuzzy.shapes import Triangle
from fuzzy.system import FuzzySystem
from tests.app.test_views import DIAGONAL, PILTAN, STAMP, Screen, buffered, finished, one_term_each


@pytest.fixture(scope="module")
def screen(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Screen]:
    folder = tmp_path_factory.mktemp("store")
    save(DIAGONAL, folder / "mine.yaml")
    server = guard.start_server(port=0)
    yield Screen(server, folder, DIAGONAL)
    server.stop()


# Which views are rendered


class Part:
    """A view of one field that counts how often it is rendered."""

    def __init__(self, field: str) -> None:
        self.field = field
        self.count = 0

    def shows(self, state: AppState) -> Shown:
        return (getattr(state, self.field),)

    def render(self, state: AppState) -> bool | None:
        self.count += 1


@pytest.fixture
def store() -> Iterator[Store]:
    loop = asyncio.new_event_loop()
    yield Store(initial(DIAGONAL), loop, turn_seconds=math.inf)
    loop.close()


def test_only_views_whose_part_has_changed_are_rendered(store: Store) -> None:
    document, playback = Part("document"), Part("playback")
    store.add(document, playback)
    store.dispatch(PlaybackChanged({"speed": 2.0}))
    assert (document.count, playback.count) == (1, 2)
    store.dispatch(Edit("paint", partial(edits.set_cell, row=0, column=0, consequent="LR")))
    assert (document.count, playback.count) == (2, 2)


@pytest.mark.parametrize(
    "event",
    [
        Edit("nothing", lambda document: document),
        Edit("refused", partial(edits.set_cell, row=99, column=0, consequent="LR")),
        Edit("a mistake", cast("Any", lambda _: 1 / 0)),
        Selected({"brush": initial(DIAGONAL).brush}),
        Noticed(Notice("Refused: that.", is_error=True)),
    ],
)
def test_what_was_not_taken_is_put_back_by_every_view(store: Store, event: Event) -> None:
    parts = [Part("document"), Part("playback")]
    store.add(*parts)
    store.dispatch(event)
    assert [part.count for part in parts] == [2, 2]


def test_news_of_something_else_renders_nothing(store: Store) -> None:
    part = Part("document")
    store.add(part)
    store.dispatch(finished(DIAGONAL, Setup(controller="pid")))  # the setup has changed since it was asked for
    assert part.count == 1


def test_what_comes_too_late_is_dropped(store: Store) -> None:
    part = Part("document")
    store.add(part)
    store.close()
    before = store.state
    store.dispatch(Edit("paint", partial(edits.set_cell, row=0, column=0, consequent="LR")))
    store._loop.close()
    store.post(Noticed(Notice("a thread has found something out")))  # the loop is gone: this would raise
    assert store.state is before
    assert part.count == 1


def test_a_view_that_fails_is_tried_again_with_the_next_event(store: Store, caplog: pytest.LogCaptureFixture) -> None:
    class Fragile(Part):
        def render(self, state: AppState) -> bool | None:
            super().render(state)
            if self.count == 2:
                raise ValueError("once")

    fragile, other = Fragile("document"), Part("document")
    store.add(fragile, other)
    store.dispatch(Edit("paint", partial(edits.set_cell, row=0, column=0, consequent="LR")))
    assert "Fragile cannot show Edit" in caplog.text
    store.dispatch(PlaybackChanged({"speed": 2.0}))
    assert (fragile.count, other.count) == (3, 2)


def test_a_value_that_was_cleaned_to_the_one_before_is_put_back(screen: Screen) -> None:
    count = screen.find("even terms")
    assert screen.send(count, 5).design.count == 5
    screen.send(count, 5.3)
    assert count.value == 5
    screen.dispatch(DesignChanged({"count": None}))


# Turns of the loop


class Slow(Part):
    """A view that takes several turns, and notes what it shows in each."""

    def __init__(self, field: str, parts: int, seen: list[tuple[str, object]]) -> None:
        super().__init__(field)
        self.parts = self.left = parts
        self.seen = seen

    def render(self, state: AppState) -> bool:
        super().render(state)
        self.seen.append((self.field, getattr(state, self.field)))
        self.left = (self.left or self.parts) - 1
        return self.left > 0


def test_views_share_the_loop_and_end_with_the_newest_state() -> None:
    async def use() -> None:
        store = Store(initial(DIAGONAL), asyncio.get_running_loop(), turn_seconds=0.0)
        seen: list[tuple[str, object]] = []
        store.add(Slow("brush", 3, seen), Slow("brush", 1, seen), Slow("playback", 1, seen))
        assert len(seen) == 5, "what is added is shown at once"
        seen.clear()
        store.dispatch(Selected({"brush": "LL"}))
        assert seen == [("brush", "LL")], "the others have to wait"
        store.dispatch(Selected({"brush": "ML"}))
        store.dispatch(PlaybackChanged({"speed": 2.0}))
        turns = 0
        while store._stale:
            count = len(seen)
            await asyncio.sleep(0)
            assert len(seen) <= count + 1, "one view a turn"
            turns += 1
        assert turns >= 1
        assert [value for field, value in seen if field == "brush"][1:] == ["ML"] * 3
        assert seen[-1][0] == "playback" or ("playback", store.state.playback) in seen
        before = len(seen)
        for _ in range(5):
            await asyncio.sleep(0)
        assert len(seen) == before, "shown once"

    asyncio.run(use())


def test_what_waits_when_the_store_is_closed_is_not_shown() -> None:
    async def use() -> None:
        store = Store(initial(DIAGONAL), asyncio.get_running_loop(), turn_seconds=0.0)
        parts = [Part("brush"), Part("brush")]
        store.add(*parts)
        store.dispatch(Selected({"brush": "LL"}))
        store.close()
        await asyncio.sleep(0)
        assert [part.count for part in parts] == [2, 1]

    asyncio.run(use())


# What is shown


def page(screen: Screen) -> dict[str, dict[str, Any]]:
    """Return everything that a browser sees: of each widget and scene node all properties."""
    asyncio.run_coroutine_threadsafe(explained(), screen.loop).result(60)
    gui, scene = cast("Any", screen.server.gui), cast("Any", screen.server.scene)
    containers = gui._container_handle_from_uuid.values()
    widgets = [
        handle for container in containers for handle in container._children.values() if hasattr(handle, "_impl")
    ]
    shown = {handle._impl.uuid: plain(handle._impl.props) | {"value": plain(handle._impl.value)} for handle in widgets}
    nodes = {name: plain(handle._impl.props) for name, handle in scene._handle_from_node_name.items()}
    return shown | nodes


async def explained() -> None:
    """Wait until chosen inputs have been explained, which is worked out beside the event loop."""
    await asyncio.gather(*(task for task in asyncio.all_tasks() if "ExplainView" in repr(task.get_coro())))


def plain(value: Any) -> Any:
    """Return a value that can be compared."""
    if isinstance(value, np.ndarray):
        return value.shape, value.tobytes()
    if isinstance(value, tuple | list):
        return tuple(plain(one) for one in value)
    if dataclasses.is_dataclass(value):
        return {name: plain(one) for name, one in vars(value).items() if not name.startswith("_")}
    return value


def drawn_anew(screen: Screen) -> dict[str, dict[str, Any]]:
    """Return the page after every view was rendered as if nothing had been shown before."""
    for name, memory in (("PlotsView", "_drawn"), ("SurfaceView", "_ways_drawn")):
        setattr(screen.view(name), memory, ())
    for view in screen.views:
        screen.on_loop(partial(view.render, screen.store.state))
    return page(screen)


FINISHED = {document.name: finished(document) for document in (DIAGONAL, PILTAN)}
SURFACES = {
    document.name: SurfaceFound(
        document, landscape(document, analysis.surface(fuzzy.compile_system(document), "de", "e", (5, 5)))
    )
    for document in (DIAGONAL, PILTAN)
}
WIDER = partial(edits.set_range, variable="de", low=-9.0, high=9.0)
ANY_EVENTS: tuple[Event, ...] = (
    *FINISHED.values(),
    *SURFACES.values(),
    *(Opened(document, f"{document.name}.yaml", STAMP, ("mine.yaml",)) for document in (DIAGONAL, PILTAN)),
    Edit("paint", partial(edits.set_cell, row=0, column=0, consequent="LR")),
    Edit("move", partial(edits.move_point, variable="e", term="PS", parameter="b", value=0.2)),
    Edit("range", WIDER),
    Edit("rename", partial(edits.rename_term, variable="e", term="PS", name="little")),
    Edit("rename", partial(edits.rename_variable, variable="T", name="torque")),
    Edit("shape", partial(edits.set_shape_kind, variable="de", term="Z", kind="gaussian")),
    Edit("title", partial(edits.set_name, name="another")),
    Edit("operator", partial(edits.set_inference, aggregation="sum")),
    Edit("list", edits.dissolve_table),
    Edit("refused", partial(edits.set_cell, row=99, column=0, consequent="LR")),
    Undo(),
    Redo(),
    Saved(DIAGONAL, "copy.yaml", STAMP, ("copy.yaml", "mine.yaml")),
    *(Selected({"variable": name}) for name in ("de", "T")),
    *(Selected({"coordinate": number}) for number in (0, 3)),
    Selected({"others": (1, 2)}),
    Selected({"charts": frozenset(CHARTS)}),
    Selected({"hidden": frozenset(LAYERS[2:])}),
    Selected({"hidden": frozenset()}),
    Selected({"brush": "ML"}),
    Selected({"drag": "free"}),
    Selected({"new_name": "that"}),
    DesignChanged({"probe": (0.1, 0.2)}),
    DesignChanged({"term_name": "this", "count": 3, "gains": (1.0, 2.0), "is_symmetric": True}),
    DesignChanged({"marked": ((0, 0),), "rule_text": "if e"}),
    SetupChanged({"scenario": "sinus"}),
    SetupChanged({"kp": 2.0, "ge": 3.0, "disturbance": "push"}),
    PlaybackChanged({"is_playing": False, "source": "replay", "time": 0.2}),
    PlaybackChanged({"speed": 5.0, "loops": False}),
    ResetRequested(),
    RunKept(),
    KeptRenamed(0, "the first"),
    KeptRemoved(0),
    Asked(Conflict("mine.yaml", STAMP)),
    Asked(None),
    Progressed(None),
    Noticed(Notice("Hear, hear.")),
    *(Advised(event.result, ()) for event in FINISHED.values()),
)


NAMED = {
    f"{number} {type(event).__name__} {getattr(event, 'label', ', '.join(getattr(event, 'changes', ())))}": event
    for number, event in enumerate(ANY_EVENTS)
}
"""Events by short names, which hypothesis can print."""


def assert_all_is_shown(screen: Screen) -> None:
    """Compare the page with what it is when every view was rendered anew."""
    found = page(screen)
    expected = drawn_anew(screen)
    assert found.keys() == expected.keys()
    different = {
        (key, name): (value, expected[key][name])
        for key, props in found.items()
        for name, value in props.items()
        if value != expected[key][name]
    }
    assert different == {}


@pytest.mark.parametrize("name", NAMED)
def test_views_that_are_passed_over_show_what_they_would_show(screen: Screen, name: str) -> None:
    settle(screen)
    screen.dispatch(NAMED[name])
    assert_all_is_shown(screen)


@given(st.lists(st.sampled_from(sorted(NAMED)), min_size=2, max_size=10))
@settings(max_examples=20)
def test_views_that_are_passed_over_show_what_they_would_show_after_any_events(
    screen: Screen, names: list[str]
) -> None:
    settle(screen)
    screen.dispatch(*(NAMED[name] for name in names))
    assert_all_is_shown(screen)


@given(st.lists(st.sampled_from(sorted(NAMED)), min_size=2, max_size=10))
@settings(max_examples=20)
def test_views_that_wait_for_their_turn_show_the_same_in_the_end(screen: Screen, names: list[str]) -> None:
    settle(screen)

    async def dispatch() -> None:
        for name in names:
            screen.store.dispatch(NAMED[name])

    screen.in_turns(dispatch)
    assert_all_is_shown(screen)


@given(st.lists(st.sampled_from(sorted(NAMED)), max_size=10))
@settings(max_examples=20)
def test_who_comes_late_sees_the_present_page(screen: Screen, names: list[str]) -> None:
    screen.dispatch(*(NAMED[name] for name in names))
    shown = page(screen)
    seen: dict[str, dict[str, Any]] = {}
    for message in buffered(screen):
        match message:
            case _messages.GuiUpdateMessage() | _messages.SceneNodeUpdateMessage():
                key = message.uuid if isinstance(message, _messages.GuiUpdateMessage) else message.name
                seen[key].update({name: plain(value) for name, value in message.updates.items()})
            case _ if hasattr(message, "props"):
                key = getattr(message, "uuid", None) or message.name
                value = {"value": plain(message.value)} if hasattr(message, "value") else {}
                seen[key] = plain(message.props) | value
            case _:
                pass
    for key, props in shown.items():
        assert {name for name, value in props.items() if name in seen[key] and seen[key][name] != value} == set(), key


# What is sent


@pytest.mark.parametrize(
    "event",
    [
        Edit("nothing", lambda document: document),
        PlaybackChanged({"speed": 1.0}),
        SetupChanged({}),
        DesignChanged({}),
        Selected({"brush": None}),
        Asked(None),
        Progressed(None),
        Noticed(None),
        finished(DIAGONAL, Setup(controller="pid")),
    ],
)
def test_an_event_that_changes_nothing_visible_sends_nothing(screen: Screen, event: Event) -> None:
    settle(screen)
    screen.sent.clear()
    screen.dispatch(event)
    assert screen.sent == []


def settle(screen: Screen, document: FuzzySystem = DIAGONAL) -> None:
    """Begin anew with a document, its run and its surface."""
    screen.store.state = initial(document, file="mine.yaml", stamp=STAMP, files=("mine.yaml",))
    screen.dispatch(FINISHED[DIAGONAL.name], SURFACES[DIAGONAL.name], Selected({"brush": None}))
    screen.dispatch(PlaybackChanged({"speed": 1.0}), SetupChanged({}), Progressed(None), Noticed(None))


# What stays behind


POOL = 50
"""Threads that viser's and asyncio's pools may have, and a few."""
GRID = cast("edits.Grid", edits.default_grid(DIAGONAL))
CYCLES: dict[str, tuple[Event, ...]] = {
    "terms": (
        Edit("add", partial(edits.add_term, variable="a", name="more", shape=Triangle(0.8, 1.0, 1.2))),
        Selected({"variable": "a", "term": "more"}),
        Edit("remove", partial(edits.remove_term, variable="a", term="more")),
    ),
    "rules": (
        Edit("add", partial(edits.add_rule, rule=parse_rule("if e is NB then T is LL", DIAGONAL))),
        DesignChanged({"rule": 0}),
        Edit("remove", partial(edits.remove_rule, number=0)),
    ),
    "tables": (Edit("dissolve", edits.dissolve_table), Edit("gather", partial(edits.give_table, grid=GRID))),
    "baselines": (RunKept(), KeptRenamed(0, "the first"), KeptRemoved(0)),
    "findings": (
        FINISHED[DIAGONAL.name],
        msgspec.structs.replace(FINISHED[DIAGONAL.name], findings=(Finding("hint", "why", "rules", ((0, 0),)),)),
    ),
    "questions": (Asked(Conflict("mine.yaml", STAMP)), Asked(None)),
    "probes": (DesignChanged({"probe": (0.1, 0.2)}), DesignChanged({"probe": None})),
}


@pytest.mark.parametrize("what", CYCLES)
def test_a_hundred_come_and_go_without_a_trace(screen: Screen, what: str) -> None:
    settle(screen, one_term_each() if what == "terms" else DIAGONAL)

    def cycle() -> None:
        screen.dispatch(*CYCLES[what])
        screen.dispatch(*[Undo()] * len(screen.store.state.past))

    def holdings() -> dict[str, int]:
        """Count what the server keeps for the page, and what works for it."""
        screen.on_loop(lambda: screen.server._run_garbage_collector(force=True))
        kept = {
            "widgets": len(page(screen)),
            "messages": len(buffered(screen)),
            "tasks": screen.on_loop(lambda: len(asyncio.all_tasks())),
        }
        for owner in (screen.server.gui, screen.server.scene):
            sizes = {name: len(value) for name, value in vars(owner).items() if isinstance(value, dict | set | list)}
            kept.update({f"{type(owner).__name__}.{name}": size for name, size in sizes.items()})
        return kept

    for _ in range(3):
        cycle()
    before = holdings()
    for _ in range(100):
        cycle()
    assert holdings() == before
    assert threading.active_count() <= POOL
