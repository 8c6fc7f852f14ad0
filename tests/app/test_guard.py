"""The guard against a real viser server: these tests fail when viser moves what the guard hooks into."""

from __future__ import annotations

import contextlib
import http.client
import socket
import threading
from collections.abc import Callable, Iterator
from typing import Any, cast

import msgspec.msgpack
import pytest
import viser
import websockets.asyncio.server
from viser import _messages
from websockets.exceptions import ConnectionClosedError, InvalidStatus
from websockets.sync.client import connect
from websockets.sync.connection import Connection
from websockets.typing import Origin, Subprotocol

from app import guard
from app.clean import MAX_UPLOAD, Refused
from app.door import MAX_MESSAGE, Door

TOKEN = "0123456789abcdef-XYZ"
PROTOCOL = Subprotocol(f"viser-v{viser.__version__}")


@contextlib.contextmanager
def running(
    token: str | None = None, host: str = "127.0.0.1", on_refused: Callable[[str], None] = lambda _: None
) -> Iterator[viser.ViserServer]:
    server = guard.start_server(host=host, port=0, token=token, on_refused=on_refused)
    try:
        yield server
    finally:
        server.stop()


@pytest.fixture(scope="module")
def server() -> Iterator[viser.ViserServer]:
    with running() as started:
        yield started


@pytest.fixture(scope="module")
def secret_server() -> Iterator[viser.ViserServer]:
    with running(TOKEN) as started:
        yield started


def get(server: viser.ViserServer, path: str = "/", **headers: str) -> http.client.HTTPResponse:
    """Send one GET request; ``Host`` is the right one unless it is given, and missing if it is empty."""
    connection = http.client.HTTPConnection("127.0.0.1", server.get_port(), timeout=10)
    with contextlib.closing(connection):
        connection.putrequest("GET", path, skip_host=True)
        for name, value in ({"Host": f"127.0.0.1:{server.get_port()}"} | headers).items():
            if value:
                connection.putheader(name, value)
        connection.endheaders()
        response = connection.getresponse()
        response.read()
        return response


def open_websocket(server: viser.ViserServer, origin: str | None = None, **headers: str) -> Connection:
    with socket.create_connection(("127.0.0.1", server.get_port())) as raw:
        host = headers.pop("Host", f"127.0.0.1:{server.get_port()}")
        return connect(
            f"ws://{host}",
            sock=raw.dup(),
            origin=cast("Origin | None", origin),
            additional_headers=headers,
            subprotocols=[PROTOCOL],
            compression=None,
        )


def refused_status(server: viser.ViserServer, origin: str | None = None, **headers: str) -> int:
    with pytest.raises(InvalidStatus) as refused:
        open_websocket(server, origin, **headers)
    return refused.value.response.status_code


def test_the_own_page_is_served(server: viser.ViserServer) -> None:
    port = server.get_port()
    for name in ("127.0.0.1", "localhost", "LOCALHOST", "[::1]"):
        assert get(server, Host=f"{name}:{port}").status == 200
    assert get(server, Origin=f"http://127.0.0.1:{port}").status == 200


def test_a_foreign_host_header_is_forbidden(server: viser.ViserServer) -> None:
    port = server.get_port()
    foreign = [
        "evil.example",
        f"evil.example:{port}",
        "127.0.0.1",
        f"127.0.0.1:{port + 1}",
        f"127.0.0.1.evil:{port}",
        "",
    ]
    for host in foreign:
        assert get(server, Host=host).status == 403, host
        if host:
            assert refused_status(server, Host=host) == 403, host


def test_a_foreign_origin_is_forbidden(server: viser.ViserServer) -> None:
    port = server.get_port()
    foreign = ["http://evil.example", f"http://evil.example:{port}", "null", f"http://127.0.0.1:{port + 1}"]
    foreign += [f"https://127.0.0.1:{port}", f"http://localhost:{port}", "http://127.0.0.1"]
    for origin in foreign:
        assert get(server, Origin=origin).status == 403, origin
        assert refused_status(server, origin) == 403, origin


def test_the_own_page_opens_a_websocket(server: viser.ViserServer) -> None:
    for origin in (f"http://127.0.0.1:{server.get_port()}", None):
        with open_websocket(server, origin) as websocket:
            assert websocket.recv(timeout=10)


def test_a_path_outside_the_page_is_not_served(server: viser.ViserServer) -> None:
    for path in ("/../_viser.py", "/%2e%2e/_viser.py", "/..%5c_viser.py"):
        assert get(server, path).status == 404


def test_without_the_token_nothing_is_served(secret_server: viser.ViserServer) -> None:
    for path in ("/", "/?token=", "/?token=wrong", f"/?token={TOKEN}x", "/?token=%C3%A9", "/assets/x"):
        assert get(secret_server, path).status == 403, path
    cookie = f"fuzzy_workbench_{secret_server.get_port()}"
    for value in ("", "wrong", TOKEN[:-1], '"\\351"', "a=b; ;="):
        assert get(secret_server, Cookie=f"{cookie}={value}").status == 403, value
    assert refused_status(secret_server) == 403


def test_the_token_is_exchanged_for_a_cookie_that_opens_page_and_websocket(secret_server: viser.ViserServer) -> None:
    response = get(secret_server, f"/?token={TOKEN}")
    assert response.status == 303
    assert response.getheader("Location") == "/"
    cookie, *attributes = (response.getheader("Set-Cookie") or "").split("; ")
    assert {"HttpOnly", "SameSite=Strict", "Path=/"} == set(attributes)
    assert get(secret_server, Cookie=cookie).status == 200
    with open_websocket(secret_server, Cookie=cookie) as websocket:
        assert websocket.recv(timeout=10)


def test_the_token_does_not_open_the_door_to_foreign_pages(secret_server: viser.ViserServer) -> None:
    assert get(secret_server, f"/?token={TOKEN}", Host="evil.example").status == 403
    assert get(secret_server, f"/?token={TOKEN}", Origin="http://evil.example").status == 403


def test_the_redirect_stays_on_this_server(secret_server: viser.ViserServer) -> None:
    assert get(secret_server, f"//evil.example/?token={TOKEN}").getheader("Location") == "/evil.example/"


@pytest.mark.parametrize("token", ["", "short", "x" * 129, "0123456789abcde;", "0123456789abcdeé"])
def test_a_token_that_can_be_guessed_or_breaks_a_header_is_refused(token: str) -> None:
    with pytest.raises(Refused, match="valid are 16 to 128"):
        guard.start_server(port=0, token=token)


def test_an_address_of_all_interfaces_answers_to_the_address_that_was_reached() -> None:
    with running(TOKEN, host="0.0.0.0") as server:
        port = server.get_port()
        cookie = f"fuzzy_workbench_{port}={TOKEN}"
        assert get(server, Host=f"127.0.0.1:{port}", Cookie=cookie).status == 200
        assert get(server, Host=f"evil.example:{port}", Cookie=cookie).status == 403


def assert_disconnected(websocket: Connection, code: int) -> None:
    with contextlib.suppress(ConnectionClosedError):
        while True:
            websocket.recv(timeout=10)
    assert websocket.protocol.close_code == code


def send(websocket: Connection, *messages: _messages.Message) -> None:
    """Send messages as viser's page does."""
    for message in messages:
        websocket.send(msgspec.msgpack.encode(message.as_serializable_dict()))


# Viser counts a client from its first camera on.
CAMERA = _messages.ViewerCameraMessage(
    wxyz=(1, 0, 0, 0),
    position=(1, 1, 1),
    fov=1,
    near=0.1,
    far=10,
    image_height=9,
    image_width=16,
    look_at=(0, 0, 0),
    up_direction=(0, 0, 1),
)


class Uploads:
    """An upload button, what it received, and the browser's side of a transfer."""

    def __init__(self, server: viser.ViserServer) -> None:
        self.received: list[bytes] = []
        self.has_last = threading.Event()
        button = server.gui.add_upload_button("upload")
        self._uuid = button._impl.uuid

        @button.on_upload
        async def _(event: viser.GuiEvent[viser.GuiUploadButtonHandle]) -> None:
            self.received.append(event.target.value.content)
            if self.received[-1] == b"last":
                self.has_last.set()

    def start(self, websocket: Connection, name: str, size: int, parts: int = 1, file: str = "a.yaml") -> None:
        send(websocket, _messages.FileTransferStartUpload(self._uuid, name, file, "text/plain", parts, size))

    def part(self, websocket: Connection, name: str, content: bytes, index: int = 0) -> None:
        send(websocket, _messages.FileTransferPart(self._uuid, name, index, content))

    def wait_until_read(self, websocket: Connection) -> None:
        """Send a small upload and wait for it: everything that was sent before it has been handled too."""
        send(websocket, CAMERA)
        self.start(websocket, "last", 4)
        self.part(websocket, "last", b"last")
        assert self.has_last.wait(timeout=10)


def asked_for_a_tunnel(monkeypatch: pytest.MonkeyPatch, *messages: _messages.Message) -> list[str]:
    """Return what viser is asked to do by messages that pass the door unchecked."""
    asked: list[str] = []
    monkeypatch.setattr(viser.ViserServer, "request_share_url", lambda self: asked.append("request"))
    monkeypatch.setattr(viser.ViserServer, "disconnect_share_url", lambda self: asked.append("disconnect"))
    monkeypatch.setattr(Door, "check", lambda self, data: None)
    with running() as server, open_websocket(server) as websocket:
        send(websocket, *messages)
        Uploads(server).wait_until_read(websocket)
        server._thread_executor.shutdown(wait=True)
    return asked


TUNNEL = (_messages.ShareUrlRequest(), _messages.ShareUrlDisconnect())


def test_nobody_can_open_the_share_tunnel(monkeypatch: pytest.MonkeyPatch) -> None:
    assert asked_for_a_tunnel(monkeypatch, *TUNNEL) == []


def test_without_the_guard_the_share_tunnel_would_open(monkeypatch: pytest.MonkeyPatch) -> None:
    """The test before this one means something only as long as the messages that it sends reach viser."""
    monkeypatch.setattr(guard, "_close_share_tunnel", lambda server: None)
    assert asked_for_a_tunnel(monkeypatch, *TUNNEL) == ["request", "disconnect"]


@pytest.mark.parametrize("message", TUNNEL, ids=lambda message: type(message).__name__)
def test_whoever_asks_for_the_share_tunnel_is_disconnected(server: viser.ViserServer, message: Any) -> None:
    websocket = open_websocket(server)
    send(websocket, message)
    assert_disconnected(websocket, 1008)


def test_no_other_page_may_frame_this_one(server: viser.ViserServer) -> None:
    for path, status in (("/", 200), ("/missing", 404)):
        response = get(server, path)
        assert response.status == status
        assert response.getheader("X-Frame-Options") == "DENY"
        assert response.getheader("X-Content-Type-Options") == "nosniff"
    assert get(server, Host="evil.example").getheader("X-Frame-Options") == "DENY"


def test_the_page_runs_no_script_but_its_own(server: viser.ViserServer) -> None:
    """The hash is that of the one script in viser's page; what comes in as HTML has none."""
    policy = get(server).getheader("Content-Security-Policy") or ""
    directives = {words[0]: words[1:] for words in (part.split() for part in policy.split(";"))}
    assert len([word for word in directives["script-src"] if word.startswith("'sha256-")]) == 1
    assert "'unsafe-inline'" not in directives["script-src"]
    assert directives["frame-ancestors"] == directives["default-src"] == directives["form-action"] == ["'none'"]


def test_an_upload_arrives() -> None:
    with running() as server, open_websocket(server) as websocket:
        uploads = Uploads(server)
        send(websocket, CAMERA)
        uploads.start(websocket, "a", 4, parts=2)
        uploads.part(websocket, "a", b"la", 0)
        uploads.part(websocket, "a", b"st", 1)
        assert uploads.has_last.wait(timeout=10)


def test_too_large_uploads_are_not_buffered() -> None:
    with running() as server, open_websocket(server) as websocket:
        uploads = Uploads(server)
        uploads.start(websocket, "understated", 10)
        uploads.part(websocket, "understated", b"x" * 11)
        uploads.start(websocket, "first", MAX_UPLOAD - 4)
        uploads.start(websocket, "second", 5)
        for number, name in enumerate(["../a.yaml", "/etc/a.yaml", "a\\b.yaml", ".a.yaml", "a.exe", "a", "C:a.yaml"]):
            uploads.start(websocket, f"name {number}", 0, file=name)
        uploads.wait_until_read(websocket)
        assert list(server.gui._current_file_upload_states) == ["first"]
    assert uploads.received == [b"last"]


@pytest.mark.parametrize(("size", "parts"), [(MAX_UPLOAD + 1, 3), (10**12, 10**6), (10, 10**6)])
def test_an_upload_that_is_too_large_is_refused_with_a_sentence_and_the_page_stays(size: int, parts: int) -> None:
    sentences: list[str] = []
    with running(on_refused=sentences.append) as server, open_websocket(server) as websocket:
        uploads = Uploads(server)
        uploads.start(websocket, "huge", size, parts)
        uploads.part(websocket, "huge", b"x" * 1000)
        uploads.wait_until_read(websocket)
        assert server.gui._current_file_upload_states == {}
    assert uploads.received == [b"last"]
    assert len(sentences) == 1
    assert "a.yaml" in sentences[0]


@pytest.mark.parametrize(("size", "parts"), [(-5, 1), (10, -1)])
def test_whoever_announces_an_impossible_upload_is_disconnected(size: int, parts: int) -> None:
    with running() as server:
        uploads = Uploads(server)
        websocket = open_websocket(server)
        uploads.start(websocket, "huge", size, parts)
        assert_disconnected(websocket, 1008)
        assert server.gui._current_file_upload_states == {}


def test_a_message_larger_than_any_upload_is_not_even_read(server: viser.ViserServer) -> None:
    websocket = open_websocket(server)
    websocket.send(b"x" * (MAX_MESSAGE + 1))
    assert_disconnected(websocket, 1009)


def test_a_busy_port_is_named_and_never_replaced_by_the_next() -> None:
    with socket.create_server(("127.0.0.1", 0)) as busy:
        port = busy.getsockname()[1]
        with pytest.raises(guard.PortBusyError, match=f"port {port} on 127.0.0.1 is busy; choose another with --port"):
            guard.start_server(port=port)


def test_a_port_that_is_taken_after_the_look_is_an_error_too(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(guard, "require_free_port", lambda host, port: None)
    with socket.create_server(("127.0.0.1", 0)) as busy:
        port = busy.getsockname()[1]
        with pytest.raises(guard.PortBusyError, match=f"port {port} is busy"):
            guard.start_server(port=port)


def test_a_viser_that_serves_otherwise_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    class Ungated:
        def __init__(self, **options: object) -> None:
            self.stopped = False

        def stop(self) -> None:
            stopped.append(self)

    stopped: list[Ungated] = []
    monkeypatch.setattr(viser, "ViserServer", Ungated)
    with pytest.raises(RuntimeError, match="no longer starts its server through"):
        guard.start_server(port=0)
    assert len(stopped) == 1


def test_websockets_is_left_as_it_was(server: viser.ViserServer) -> None:
    assert isinstance(websockets.asyncio.server.serve, type)


def test_nothing_is_printed_at_the_start(capsys: pytest.CaptureFixture[str]) -> None:
    with running():
        assert capsys.readouterr().out == ""


@pytest.mark.parametrize(
    ("host", "expected"),
    [
        *[(host, True) for host in ("127.0.0.1", "127.3.2.1", "::1", "[::1]", "LocalHost")],
        *[(host, False) for host in ("0.0.0.0", "192.168.1.2", "::", "localhost.evil.example")],
    ],
)
def test_loopback_addresses_are_known(host: str, expected: bool) -> None:
    assert guard.is_loopback(host) is expected


def test_an_address_of_another_machine_cannot_be_listened_on() -> None:
    with pytest.raises(OSError, match=r"cannot listen on 192\.0\.2\.1:0"):
        guard.require_free_port("192.0.2.1", 0)
    with pytest.raises(OSError, match="no such host"):
        guard.require_free_port("host.invalid.", 0)
