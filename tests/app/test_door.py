"""The door against a raw websocket: of what no hand can enter into the real page's widgets, nothing is accepted."""

from __future__ import annotations

import contextlib
import math
import shutil
import socket
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec
import pytest
import viser
from hypothesis import given, settings
from hypothesis import strategies as st
from viser._messages import FileTransferPartAck
from websockets.exceptions import ConnectionClosedError
from websockets.sync.client import connect
from websockets.sync.connection import Connection
from websockets.typing import Subprotocol

from app.clean import Refused
from app.door import MAX_NUMBER, TELL_SECONDS, Door, StaleError, check_value
from app.state import Advised, Event, Noticed, PlaybackChanged, Progressed, RunFinished
from app.workbench import Workbench

RULEBASES = Path(__file__).parents[2] / "rulebases"
LONG = "x" * 30_000
PATIENCE = 120.0
"""Seconds for what takes a tenth of one, unless kernels have to be compiled."""
JUNK: list[Any] = [None, math.nan, [], {}, {"a": [1, {}]}, b"\xff", LONG]
"""No widget takes these."""

CAMERA: dict[str, Any] = {
    "type": "ViewerCameraMessage",
    "wxyz": [1, 0, 0, 0],
    "position": [1, 1, 1],
    "fov": 1.0,
    "near": 0.1,
    "far": 10,
    "image_height": 9,
    "image_width": 16,
    "look_at": [0, 0, 0],
    "up_direction": [0, 0, 1],
}


class Intruder:
    """A raw websocket to a real workbench, and what the workbench makes of it."""

    def __init__(self, workbench: Workbench) -> None:
        self.workbench = workbench
        self.events: list[Event] = []
        self._marks = 0
        dispatch = workbench.store.dispatch

        def hear(event: Event) -> None:
            if not isinstance(event, RunFinished | Advised | Progressed):  # these come from threads
                self.events.append(event)
            dispatch(event)

        workbench.store.dispatch = hear
        self.connect()

    def connect(self) -> None:
        port = self.workbench.server.get_port()
        raw = socket.create_connection(("127.0.0.1", port))
        version = Subprotocol(f"viser-v{viser.__version__}")
        self.socket: Connection = connect(
            f"ws://127.0.0.1:{port}", sock=raw, subprotocols=[version], compression=None, max_size=None
        )
        self.wait_until_read()

    def send(self, message: Any) -> None:
        self.socket.send(msgspec.msgpack.encode(message))

    def update(self, handle: Any, value: object) -> None:
        self.send({"type": "GuiUpdateMessage", "uuid": handle._impl.uuid, "updates": {"value": value}})

    def wait_until_read(self) -> None:
        """Return when everything that was sent before has been handled."""
        self._marks += 1
        mark = 1.0 + self._marks / 1024
        self.send(CAMERA | {"fov": mark})
        deadline = time.monotonic() + PATIENCE
        while not any(client.camera.fov == mark for client in self.workbench.server.get_clients().values()):
            assert time.monotonic() < deadline, "the workbench no longer reads"
            time.sleep(0.005)

    def assert_disconnected(self) -> None:
        with contextlib.suppress(ConnectionClosedError):
            while True:
                self.socket.recv(timeout=20)
        assert self.socket.protocol.close_code == 1008
        self.connect()

    def handles(self) -> list[Any]:
        return list(self.workbench.server.gui._gui_input_handle_from_uuid.values())

    def notes(self) -> Any:
        return next(handle for handle in self.handles() if handle._impl.props.label == "notes")


@pytest.fixture(scope="module")
def workbench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Workbench]:
    folder = Path(shutil.copytree(RULEBASES, tmp_path_factory.mktemp("door") / "rulebases"))
    started = Workbench(folder / "diagonal.yaml", port=0)
    deadline = time.monotonic() + PATIENCE
    while started.store.state.runs.current is None:  # a run changes what widgets show
        assert time.monotonic() < deadline, "no run"
        time.sleep(0.01)
    yield started
    started.stop()


@pytest.fixture(scope="module")
def intruder(workbench: Workbench) -> Iterator[Intruder]:
    visitor = Intruder(workbench)
    yield visitor
    visitor.socket.close()


def hostile_values(handle: Any) -> list[Any]:
    """Return what no hand can enter into a widget, at least seven values."""
    props, present = handle._impl.props, handle._impl.value
    match handle:
        case viser.GuiButtonHandle() | viser.GuiCheckboxHandle():
            return [*JUNK, 0, 1, "true", [True]]
        case viser.GuiButtonGroupHandle() | viser.GuiDropdownHandle():
            return [*JUNK, 0, "not an option", f"{present} ", "<img src=x onerror=alert(1)>", list(props.options)]
        case viser.GuiSliderHandle() | viser.GuiNumberHandle():
            low = -MAX_NUMBER if props.min is None else props.min
            high = MAX_NUMBER if props.max is None else props.max
            out = [low - 1 - abs(low) / 1e3, high + 1 + abs(high) / 1e3, math.inf, -math.inf]
            return [*JUNK, *out, True, "1", str(present), [present]]
        case viser.GuiMultiSliderHandle():
            count = len(present)
            out = [[props.min] * (count + 1), [props.max] * (count - 1), [props.max + 1] * count, [math.nan] * count]
            return [*JUNK, *out, [None] * count, [str(one) for one in present], dict(enumerate(present))]
        case viser.GuiVector2Handle() | viser.GuiVector3Handle() | viser.GuiRgbHandle() | viser.GuiRgbaHandle():
            count = len(present)
            out = [[MAX_NUMBER * 2] * count, [-MAX_NUMBER * 2] * count, [math.inf] * count, list(present) * 2]
            return [*JUNK, *out, [None] * count, [str(one) for one in present], 1.0]
        case viser.GuiUploadButtonHandle():
            return [*JUNK, 1, "a.yaml", {"name": "a.yaml", "content": b"x"}]
        case viser.GuiTextHandle():
            return [None, 5, math.nan, True, ["a"], {}, b"bytes", LONG, "\x00", "\x1b[2J", "\x7f"]
        case _:
            raise AssertionError(f"a widget of a kind that no hostile value is known for: {type(handle).__name__}")


def test_of_every_widget_no_hostile_value_is_accepted(intruder: Intruder) -> None:
    handles = intruder.handles()
    assert len(handles) > 40
    visible = {handle._impl.uuid: handle._impl.props.visible for handle in handles}
    intruder.workbench.store.post(PlaybackChanged({"is_playing": False}))  # the time's slider stands still
    intruder.wait_until_read()
    before = {handle._impl.uuid: handle._impl.value for handle in handles}
    document, sent = intruder.workbench.store.state.document, 0
    intruder.events.clear()
    for handle in handles:
        handle._impl.props.visible = True
        values = hostile_values(handle)
        assert len(values) >= 7
        for value in values:
            with pytest.raises(Refused):
                check_value(handle, value)
            intruder.update(handle, value)
            sent += 1
        handle._impl.props.visible = visible[handle._impl.uuid]
    intruder.wait_until_read()
    assert sent >= 7 * len(handles)
    assert {handle._impl.uuid: handle._impl.value for handle in handles} == before
    assert [event for event in intruder.events if not isinstance(event, Noticed)] == []
    assert intruder.workbench.store.state.document is document


def test_what_a_hand_can_enter_is_accepted(intruder: Intruder) -> None:
    """The test before this one means something only as long as messages like its own have an effect."""
    intruder.update(intruder.notes(), "remarks")
    intruder.wait_until_read()
    assert intruder.workbench.store.state.document.notes == "remarks"


@pytest.mark.parametrize("prop", ["disabled", "hidden"])
def test_a_widget_that_cannot_be_changed_is_not_changed(intruder: Intruder, prop: str) -> None:
    notes = intruder.notes()
    before = intruder.workbench.store.state.document
    props: Any = notes._impl.props
    setattr(props, *{"disabled": ("disabled", True), "hidden": ("visible", False)}[prop])
    with pytest.raises(StaleError):
        check_value(notes, "hello")
    intruder.update(notes, "hello")
    intruder.wait_until_read()
    props.disabled, props.visible = False, True
    assert intruder.workbench.store.state.document is before
    assert notes.value == before.notes


def test_the_browser_is_told_the_value_that_is(intruder: Intruder, monkeypatch: pytest.MonkeyPatch) -> None:
    queued: list[Any] = []
    interface: Any = intruder.workbench.server._websock_server
    monkeypatch.setattr(interface, "queue_message", queued.append)
    number = next(h for h in intruder.handles() if isinstance(h, viser.GuiNumberHandle) and h.visible)
    time.sleep(2 * TELL_SECONDS)
    intruder.update(number, math.nan)
    intruder.wait_until_read()
    updates = [one.updates for one in queued if getattr(one, "uuid", None) == number._impl.uuid]
    assert {"value": number.value} in updates
    notice = intruder.workbench.store.state.notice
    assert notice is not None
    assert notice.text.startswith("Refused: ")
    assert "nan" in notice.text


def forged(handle: Any) -> list[dict[str, Any]]:
    """Return messages that the page never sends."""
    uuid = handle._impl.uuid
    return [
        {"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"removed": True}},
        {"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"value": "a", "update_cb": []}},
        {"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"props": None}},
        {"type": "GuiUpdateMessage", "uuid": uuid, "updates": {}},
        {"type": "GuiUpdateMessage", "uuid": uuid, "updates": [1]},
        {"type": "GuiUpdateMessage", "uuid": 5, "updates": {"value": "a"}},
        {"type": "GuiUpdateMessage", "uuid": "x" * 65, "updates": {"value": "a"}},
        {"type": "GuiFormDirtyMessage", "uuid": "x"},
        {"type": "GuiButtonHoldMessage", "uuid": uuid, "frequency": 1.0},
        {"type": "GuiRemoveMessage", "uuid": uuid},
        {"type": "RunJavascriptMessage", "source": "alert(1)"},
        {"type": "GetRenderResponseMessage", "payload": b"x"},
        {"type": "NoSuchMessage"},
        {"type": CAMERA["type"]},
        CAMERA | {"fov": "wide"},
        CAMERA | {"position": [1, 1]},
        CAMERA | {"image_width": -1},
        CAMERA | {"extra": 1},
        {},
    ]


def test_messages_that_the_page_never_sends_end_the_connection(intruder: Intruder) -> None:
    handle = intruder.handles()[0]
    before = intruder.workbench.store.state.document
    for message in forged(handle):
        intruder.send(message)
        with contextlib.suppress(ConnectionClosedError):
            intruder.send({"type": "GuiUpdateMessage", "uuid": handle._impl.uuid, "updates": {"value": "too late"}})
        intruder.assert_disconnected()
    for data in (b"", b"\xc1", b"\x91" * 100_000, "text"):
        intruder.socket.send(data)
        intruder.assert_disconnected()
    assert intruder.workbench.store.state.document is before
    assert handle._impl.removed is False


def test_coordinates_are_finite_and_instances_exist(intruder: Intruder, workbench: Workbench) -> None:
    clicked: list[Any] = []
    box = workbench.server.scene.add_box("/box")

    async def click(event: Any) -> None:
        clicked.append(event.ray_origin)

    box.on_click(click)
    message = {
        "type": "SceneNodeClickMessage",
        "name": "/box",
        "instance_index": None,
        "ray_origin": [0, 0, 1],
        "ray_direction": [0, 0, -1],
        "screen_pos": [0.5, 0.5],
        "modifier": None,
        "owner": "",
    }
    hostile: list[dict[str, Any]] = [
        {"ray_origin": [math.nan, 0, 0]},
        {"ray_direction": [0, 0, math.inf]},
        {"screen_pos": [1e300, 0]},
        {"instance_index": 3},
        {"name": "/nowhere"},
    ]
    for change in hostile:
        intruder.send(message | change)
    for hostile_camera in ({"position": [math.nan, 0, 0]}, {"image_height": 0, "fov": 9.0}, {"fov": math.inf}):
        intruder.send(CAMERA | hostile_camera)
    intruder.send(message)
    intruder.wait_until_read()
    assert clicked == [(0.0, 0.0, 1.0)]
    assert all(client.camera.image_height for client in workbench.server.get_clients().values())
    box.remove()


json_like = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**63), 2**64 - 1)
    | st.floats()
    | st.text(max_size=9)
    | st.binary(max_size=9),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=9), inner, max_size=3),
    max_leaves=6,
)


@given(st.binary(max_size=60) | json_like.map(msgspec.msgpack.encode))
@settings(max_examples=300)
def test_any_bytes_are_refused_in_order(data: bytes) -> None:
    with pytest.raises((msgspec.MsgspecError, Refused)):
        Door(lambda _: None).check(data)


@given(st.sampled_from(["value", "updates", "uuid", "name", "phase", "fov"]), json_like)
@settings(max_examples=200)
def test_any_field_of_any_message_is_refused_in_order(field: str, value: Any) -> None:
    update = {"type": "GuiUpdateMessage", "uuid": "u", "updates": {"value": value}}
    for message in (update, update | {field: value}, CAMERA | {field: value}):
        with contextlib.suppress(msgspec.MsgspecError, Refused):
            Door(lambda _: None).check(msgspec.msgpack.encode(message))


def test_an_upload_that_is_refused_is_over_for_the_browser(intruder: Intruder) -> None:
    button = next(handle for handle in intruder.handles() if isinstance(handle, viser.GuiUploadButtonHandle))
    start = {
        "type": "FileTransferStartUpload",
        "source_component_uuid": button._impl.uuid,
        "transfer_uuid": "refused",
        "filename": "notes.txt",
        "mime_type": "text/plain",
        "part_count": 1,
        "size_bytes": 5,
    }
    intruder.send(start)
    intruder.wait_until_read()
    server: Any = intruder.workbench.server
    sent = server._websock_server.get_message_buffer().message_from_id.values()
    over = [one for one in sent if isinstance(one, FileTransferPartAck) and one.transfer_uuid == "refused"]
    assert [(one.source_component_uuid, one.transferred_bytes, one.total_bytes) for one in over] == [
        (button._impl.uuid, 5, 5)
    ], "its button would wait for ever"
