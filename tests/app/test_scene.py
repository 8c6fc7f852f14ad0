"""The scene on a real viser server, without a browser: tiles, ghosts, hand, surface, cameras."""

from __future__ import annotations

import asyncio
import contextlib
import io
import math
from collections.abc import Callable, Coroutine, Iterator
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
import trimesh
from viser import _messages

import fuzzy
from app import experiment, guard
from app.runner import Frame, result_of
from app.runner.frames import ghosts, row_at
from app.scene.board import BoardView
from app.scene.cameras import CAMERAS, PHONE, WIDE, Window, fitted, follow, look
from app.scene.landscape import landscape
from app.scene.scene import Scene
from app.scene.stage import base_height, to_plane, to_scene
from app.state import (
    LAYERS,
    AppState,
    Edit,
    KeptRemoved,
    PlaybackChanged,
    Result,
    RunFinished,
    RunKept,
    Selected,
    Setup,
    SurfaceFound,
    initial,
)
from app.store import Store
from fuzzy import analysis, edits
from fuzzy.formats import load
from robot import controllers
from robot.arm import Arm
from robot.pull import Pull

DIAGONAL = load(Path(__file__).parents[2] / "rulebases" / "diagonal.yaml")


class Stage:
    """The scene over a server and a store."""

    def __init__(self) -> None:
        self.server = guard.start_server(port=0)
        self.loop = self.server.get_event_loop()
        self.pulls: list[Pull | None] = []
        self.sent: list[_messages.Message] = []
        interface: Any = self.server._websock_server
        real = interface.queue_message

        def queue_message(message: _messages.Message) -> None:
            self.sent.append(message)
            real(message)

        interface.queue_message = queue_message
        self.store = Store(initial(DIAGONAL), self.loop, turn_seconds=math.inf)
        self.run(self._build)

    def _build(self) -> None:
        self.scene = Scene(self.server, self.store, self.pulls.append)
        self.store.add(*self.scene.views)

    def run(self, do: Callable[[], object]) -> None:
        async def on_loop() -> None:
            do()

        self.wait(on_loop())

    def wait(self, coroutine: Coroutine[Any, Any, None]) -> None:
        asyncio.run_coroutine_threadsafe(coroutine, self.loop).result(60)

    def dispatch(self, *events: Any) -> AppState:
        for event in events:
            self.run(lambda event=event: self.store.dispatch(event))
        return self.store.state

    def show(self, frame: Frame) -> None:
        self.run(lambda: self.scene.show(frame))

    def node(self, name: str) -> Any:
        return cast("Any", self.server.scene)._handle_from_node_name[name]

    def nodes(self, prefix: str) -> set[str]:
        return {name for name in cast("Any", self.server.scene)._handle_from_node_name if name.startswith(prefix)}

    def press(self, number: int | None) -> AppState:
        board = next(part for part in self.scene.views if isinstance(part, BoardView))
        self.wait(board._clicked(cast("Any", SimpleNamespace(instance_index=number))))
        return self.store.state

    def drag(self, phase: str, end: tuple[float, float, float]) -> None:
        event: Any = SimpleNamespace(phase=phase, start_position=(0.0, 0.0, 0.2), end_position=end)
        self.wait(self.scene._dragged(event))


@pytest.fixture
def stage() -> Iterator[Stage]:
    started = Stage()
    yield started
    started.server.stop()


@pytest.fixture(scope="module")
def result() -> Result:
    return result_of(experiment.prepare(Setup(duration=0.5), fuzzy.compile_system(DIAGONAL)))


def frame(result: Result, row: int) -> Frame:
    run = result.run
    inference = controllers.inference_of(run.controller)
    assert inference is not None
    inputs = run.inputs[row, 0]
    strength = inference.explain(*inputs).strength
    return Frame(
        run.arm, float(run.t[row]), run.q[row], run.reference[row], run.forces[row], inputs, inference, strength, 1.0,
        None, run.inputs[row], run.output[row],
    )  # fmt: skip


def finished(result: Result) -> RunFinished:
    return RunFinished(DIAGONAL, Setup(), result, result)


def test_a_click_on_a_tile_paints_as_the_grid_does(stage: Stage) -> None:
    stage.dispatch(Selected({"brush": "LL"}))
    state = stage.press(10)
    assert edits.rule_table(state.document).cells[1][3] == "LL"
    assert state.past[-1].label == "(NM, Z) → LL"
    for missing in (None, -1, 49, 10**9):
        assert stage.press(missing).document is state.document


def test_tiles_rise_with_what_fires_and_are_as_many_as_cells(stage: Stage, result: Result) -> None:
    stage.dispatch(finished(result))
    shown = frame(result, 0)
    assert shown.strength is not None
    stage.show(shown)
    heights = stage.node("/board/tiles").batched_scales[:, 2]
    np.testing.assert_allclose((heights - heights.min()) / 0.05, shown.strength.round(2), atol=1e-5)
    stage.dispatch(Edit("fewer", lambda system: edits.remove_term(system, "e", "NB")))
    assert len(stage.node("/board/tiles").batched_scales) == 42


def test_names_on_the_board_follow_a_renaming(stage: Stage) -> None:
    label, tiles = stage.node("/board/row/1"), stage.node("/board/tiles")
    assert label.text == "NB"
    stage.dispatch(
        Edit("rename", partial(edits.rename_term, variable="e", term="NB", name="far left")),
        Edit("rename", partial(edits.rename_variable, variable="e", name="error")),
    )
    assert stage.node("/board/row/1") is label
    assert stage.node("/board/tiles") is tiles
    assert (label.text, stage.node("/board/row/0").text) == ("far left", "error")


def test_long_names_are_cut_where_the_next_one_stands(stage: Stage) -> None:
    stage.dispatch(
        Edit("rename", partial(edits.rename_term, variable="e", term="NB", name="W" * 64)),
        Edit("rename", partial(edits.rename_variable, variable="de", name="d" * 64)),
    )
    assert stage.node("/board/row/1").text == "W" * 7 + "…"
    assert stage.node("/board/column/0").text == "d" * 11 + "…"


def test_tiles_have_the_colours_of_what_they_conclude(stage: Stage) -> None:
    before = stage.node("/board/tiles").batched_colors.copy()
    stage.dispatch(Selected({"brush": "LL"}))
    stage.press(48)
    after = stage.node("/board/tiles").batched_colors
    assert (before[:48] == after[:48]).all()
    assert (after[48] == before[0]).all(), "LL is LL everywhere"


def test_a_frame_updates_the_scene_in_place_and_hidden_layers_send_nothing(stage: Stage, result: Result) -> None:
    surface = landscape(DIAGONAL, analysis.surface(fuzzy.compile_system(DIAGONAL), "de", "e", (11, 11)))
    stage.dispatch(finished(result), SurfaceFound(DIAGONAL, surface))
    for row in (0, 50, 100):
        stage.show(frame(result, row))
    stage.sent.clear()
    stage.show(frame(result, 150))
    kinds = {type(message) for message in stage.sent}
    assert kinds <= {_messages.SceneNodeUpdateMessage, _messages.SetPositionMessage}, kinds
    assert len(stage.sent) < 30
    stage.dispatch(Selected({"hidden": frozenset(LAYERS)}))
    stage.show(frame(result, 151))
    stage.sent.clear()
    stage.show(frame(result, 200))
    names = {cast("Any", message).name for message in stage.sent}
    assert names
    assert all(name.startswith("/arm/") and "kept" not in name for name in names), names


def test_rendering_again_sends_nothing(stage: Stage, result: Result) -> None:
    surface = landscape(DIAGONAL, analysis.surface(fuzzy.compile_system(DIAGONAL), "de", "e", (11, 11)))
    state = stage.dispatch(finished(result), SurfaceFound(DIAGONAL, surface), Selected({"others": (3,)}))
    stage.sent.clear()
    for _ in range(3):
        for view in stage.scene.views:
            stage.run(lambda view=view: view.render(state))
    assert stage.sent == []


def test_kept_runs_stand_beside_the_arm_at_the_same_time(stage: Stage, result: Result) -> None:
    state = stage.dispatch(finished(result), RunKept())
    found = ghosts(state.runs.kept, result.run.arm, 0.1)
    assert [ghost.slot for ghost in found] == [0]
    np.testing.assert_array_equal(found[0].q, result.run.q[row_at(result.run, 0.1)])
    stage.show(frame(result, 100)._replace(ghosts=found))
    assert stage.node("/arm/kept/1").visible
    assert not stage.node("/arm/kept/2").visible
    stage.dispatch(KeptRemoved(0))
    stage.show(frame(result, 101))
    assert not stage.node("/arm/kept/1").visible
    assert row_at(result.run, 1e9) == len(result.run.t) - 1


def test_a_hand_pulls_where_it_grips_and_only_to_a_sensible_place(stage: Stage, result: Result) -> None:
    stage.dispatch(finished(result))
    stage.show(frame(result, 0))
    stage.drag("start", (0.05, 0.0, 0.2))
    for end in [(0.10, 0.0, 0.25), (float("nan"), 0.0, 0.25), (1e9, 0.0, 0.25)]:
        stage.drag("update", end)
    stage.drag("end", (0.10, 0.0, 0.25))
    first, second, last = stage.pulls
    assert first is not None
    assert second is not None
    assert last is None
    assert first.point == second.point
    assert second.place[0] == 0.10
    assert second.place[1] - first.place[1] == pytest.approx(-0.05)
    stage.show(frame(result, 1)._replace(pull=second))
    assert stage.node("/marks/hand").visible
    assert stage.node("/marks/force").text.endswith(" N")
    stage.show(frame(result, 2))
    assert not stage.node("/marks/hand").visible
    stage.dispatch(PlaybackChanged({"source": "replay"}))
    stage.drag("start", (0.05, 0.0, 0.2))
    assert stage.pulls[-1] is None, "a replay cannot be pulled"


def test_the_surface_is_drawn_once_a_document_with_places_for_the_chosen(stage: Stage, result: Result) -> None:
    surface = landscape(DIAGONAL, analysis.surface(fuzzy.compile_system(DIAGONAL), "de", "e", (11, 11)))
    stage.dispatch(finished(result), SurfaceFound(DIAGONAL, surface))
    meshes = [message for message in stage.sent if isinstance(message, _messages.GlbMessage)]
    assert len(meshes) == 1
    mesh: Any = trimesh.load(io.BytesIO(meshes[0].props.glb_data), file_type="glb", force="mesh")
    assert (len(mesh.vertices), len(mesh.faces)) == (121, 200)
    assert mesh.extents.max() == pytest.approx(0.4)
    stage.sent.clear()
    stage.dispatch(Selected({"others": (1, 5)}))
    stage.show(frame(result, 10))
    assert not any(isinstance(message, _messages.GlbMessage) for message in stage.sent)
    assert stage.nodes("/surface/places/") == {f"/surface/places/{i}" for i in (0, 1, 5)}
    stage.dispatch(Selected({"others": ()}))
    assert stage.nodes("/surface/ways/") == {"/surface/ways/s1"}
    stage.dispatch(SurfaceFound(DIAGONAL, None))
    assert not stage.node("/surface/mesh").visible


def test_the_ways_between_plane_and_scene_are_inverse() -> None:
    height = base_height(Arm.preset("soft"))
    for place in [(0.1, 0.3), (-0.2, 0.0)]:
        x, y, z = to_scene(np.array(place), height)
        assert y == 0.0
        assert to_plane((float(x), float(y), float(z)), height) == pytest.approx(place)


def client(width: int, height: int) -> Any:
    """Return what stands for a browser: a camera that keeps where it was put, and tells of new windows."""
    heard: list[Any] = []
    camera = SimpleNamespace(
        image_width=width, image_height=height, position=None, look_at=None, up_direction=None, on_update=heard.append
    )
    return SimpleNamespace(camera=camera, atomic=contextlib.nullcontext, heard=heard)


@pytest.mark.parametrize("name", CAMERAS)
@pytest.mark.parametrize(("width", "height"), [(390, 844), (576, 900), (577, 900), (598, 768), (1366, 768)])
def test_a_camera_steps_back_in_a_narrow_window_and_lifts_the_scene_above_a_phones_panels(
    name: str, width: int, height: int
) -> None:
    browser = client(width, height)
    look(browser, name)
    position, target = (np.array(place) for place in CAMERAS[name])
    at, middle = np.array(browser.camera.position), np.array(browser.camera.look_at)
    away, before = at - middle, position - target
    if width > PHONE:
        np.testing.assert_allclose(middle, target)
        np.testing.assert_allclose(away, before * max(1.0, WIDE * height / width), atol=1e-12)
        return
    assert away[2] / np.linalg.norm(away) > before[2] / np.linalg.norm(before), "steeper"
    assert np.linalg.norm(away) * width / height >= 0.75 * np.linalg.norm(before)
    lift = target - middle
    assert lift @ away == pytest.approx(0.0, abs=1e-12)
    assert lift[2] > 0.0
    assert 0.25 < np.linalg.norm(lift) / np.linalg.norm(away) < np.tan(np.radians(37.5)), "within the upper half"


def test_a_view_follows_the_window_until_a_hand_moves_the_camera() -> None:
    async def use() -> None:
        browser = client(1366, 768)
        await follow(browser)
        camera, moved = browser.camera, browser.heard[0]
        camera.position, camera.look_at = CAMERAS["all"]
        for width, height in ((598, 768), (900, 900), (500, 400)):
            camera.image_width, camera.image_height = width, height
            await moved(camera)
            expected = fitted(CAMERAS["all"], Window(width, height))
            np.testing.assert_allclose((camera.position, camera.look_at), expected)
        there = np.array(camera.position) + 0.1
        camera.position = there.copy()
        await moved(camera)
        camera.image_width = 1000
        await moved(camera)
        np.testing.assert_array_equal(camera.position, there)

    asyncio.run(use())
