"""Who may connect: a viser server that answers only its own page.

Viser listens without authentication, accepts a websocket from any page, buffers uploads of any size and lets every
browser open a public tunnel. :func:`start_server` closes these doors. Every private name of viser's that this takes
stands in this module and in :mod:`app.door`, which decides what may be sent by those who are connected;
``tests/app/test_guard.py`` and ``test_door.py`` fail when one of them moves.
"""

from __future__ import annotations

import base64
import contextlib
import errno
import hashlib
import hmac
import http
import http.client
import io
import ipaddress
import logging
import os
import re
import socket
import threading
import time
import urllib.parse
from collections.abc import Callable, Iterator
from http.cookies import CookieError, SimpleCookie
from pathlib import Path
from typing import Any, cast

import viser
import websockets.asyncio.server
from viser import _messages
from websockets.asyncio.server import ServerConnection
from websockets.http11 import Request, Response

from app.clean import Refused
from app.door import MAX_MESSAGE, Door

_CLOSE_SECONDS = 0.5
"""How long a browser may take to say goodbye when the server ends."""

LOOPBACK_NAMES = ("localhost", "127.0.0.1", "[::1]")
"""Hosts, as a browser writes them, that lead to this machine alone."""


_HEADERS = {
    "X-Frame-Options": "DENY",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
}
"""What every answer forbids other pages: to frame this one and to catch clicks, to load it, to learn its address."""


def content_security_policy() -> str:
    """Return what the page may do: run viser's own script and what that loads, and talk to this server alone.

    HTML that reaches the page, from whatever name or file, thereby runs nothing even if it was not escaped.
    """
    page = (Path(viser.__file__).parent / "client" / "build" / "index.html").read_text(encoding="utf-8")
    scripts = re.findall(r"<script[^>]*>(.*?)</script>", page, re.DOTALL)
    digests = (base64.b64encode(hashlib.sha256(script.encode()).digest()).decode() for script in scripts)
    hashes = " ".join(f"'sha256-{digest}'" for digest in digests)
    return (
        f"default-src 'none'; script-src {hashes} 'strict-dynamic' 'unsafe-eval'; worker-src blob:; "
        "style-src 'unsafe-inline'; img-src 'self' data: blob:; font-src data:; connect-src 'self' data: blob:; "
        "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )


class PortBusyError(OSError):
    """The port is taken; the message names it and says how to choose another."""


def is_loopback(host: str) -> bool:
    """Tell whether ``host`` can be reached from this machine alone."""
    with contextlib.suppress(ValueError):
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    return host.lower() == "localhost"


def require_free_port(host: str, port: int) -> None:
    """Raise :class:`PortBusyError` if ``port`` is taken, or another OSError if ``host`` cannot be listened on."""
    try:
        found = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
    except (OSError, UnicodeError) as error:
        raise OSError(f"cannot listen on {host!r}: no such host") from error
    for family, kind, protocol, _, address in found:
        with socket.socket(family, kind, protocol) as probe:
            if os.name == "posix":  # as asyncio does: a port that was just left is free
                probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            if family == socket.AF_INET6:
                probe.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 1)
            try:
                probe.bind(address)
                probe.listen(1)
            except PermissionError as error:
                raise OSError(f"port {port} needs more rights than yours; choose one from 1024 with --port") from error
            except OSError as error:
                if error.errno != errno.EADDRINUSE:
                    raise OSError(f"cannot listen on {host}:{port}: {error.strerror}") from error
                raise PortBusyError(f"port {port} on {host} is busy; choose another with --port") from error


class Gate:
    """Decides which HTTP requests and websocket handshakes are answered; everything else gets 403.

    Args:
        host: Address that the server listens on. Other machines can only name this one when it is not a loopback
            address.
        token: Secret that the first request carries as ``?token=`` and later ones as a cookie; None for no token.
    """

    def __init__(self, host: str, token: str | None) -> None:
        self._names = set(LOOPBACK_NAMES)
        self._is_open_to_others = not is_loopback(host)
        if self._is_open_to_others:
            self._names |= {_host_name(host), socket.gethostname().lower()}
        self._token = token
        self.is_open = False

    def answer(self, connection: ServerConnection, request: Request) -> Response | None:
        """Return the response that ends this request here, or None when the request may go on."""
        if not self.is_open:
            return connection.respond(http.HTTPStatus.SERVICE_UNAVAILABLE, "The workbench is starting.\n")
        address, port = connection.local_address[:2]
        hosts = request.headers.get_all("Host")
        if len(hosts) != 1 or hosts[0].lower() not in self._valid_hosts(address, port):
            return _forbid(connection, f"The Host header is not this server's: open http://127.0.0.1:{port} instead.")
        origins = request.headers.get_all("Origin")
        if origins and origins != [f"http://{hosts[0]}"]:
            return _forbid(connection, "Pages of other origins may not connect.")
        return None if self._token is None else self._check_token(connection, request, port)

    def _valid_hosts(self, address: str, port: int) -> set[str]:
        names = set(self._names)
        if self._is_open_to_others:
            names.add(_host_name(address))  # the address itself: a rebound name can never look like one
        return {f"{name}:{port}" for name in names} | (names if port == http.client.HTTP_PORT else set())

    def _check_token(self, connection: ServerConnection, request: Request, port: int) -> Response | None:
        cookie = f"fuzzy_workbench_{port}"  # cookies know no ports
        path, _, query = request.path.partition("?")
        for given in urllib.parse.parse_qs(query).get("token", []):
            if self._is_token(given):
                # Viser's page would build its websocket's address from this one: go on without the query.
                response = connection.respond(http.HTTPStatus.SEE_OTHER, "")
                response.headers["Location"] = "/" + path.lstrip("/")
                response.headers["Set-Cookie"] = f"{cookie}={given}; HttpOnly; SameSite=Strict; Path=/"
                return response
        with contextlib.suppress(CookieError):
            for header in request.headers.get_all("Cookie"):
                morsel = SimpleCookie(header).get(cookie)
                if morsel is not None and self._is_token(morsel.value):
                    return None
        return _forbid(connection, "This workbench needs its token: open the address that it printed when it started.")

    def _is_token(self, given: str) -> bool:
        return hmac.compare_digest(given.encode(errors="replace"), cast("str", self._token).encode())


def _forbid(connection: ServerConnection, sentence: str) -> Response:
    return connection.respond(http.HTTPStatus.FORBIDDEN, sentence + "\n")


def _host_name(address: str) -> str:
    """Return an address or name as the Host header writes it."""
    bare = address.strip("[]").lower()
    return f"[{bare}]" if ":" in bare else bare


def address(host: str, port: int, token: str | None) -> str:
    """Return the address to open in a browser; for all interfaces it is the one with this machine's name."""
    is_everywhere = host.strip("[]") in ("", "0.0.0.0", "::")
    name = socket.gethostname().lower() if is_everywhere else _host_name(host)
    return f"http://{name}:{port}" + (f"/?token={token}" if token else "")


def wait_until_served(host: str, port: int) -> None:
    """Return when a server on ``host`` and ``port`` answers requests, as :func:`start_server`'s do once guarded."""
    reached = {"": "127.0.0.1", "0.0.0.0": "127.0.0.1", "::": "::1"}.get(host, host)
    while True:
        connection = http.client.HTTPConnection(reached, port, timeout=5)
        with contextlib.closing(connection), contextlib.suppress(OSError, http.client.HTTPException):
            connection.request("GET", "/")
            if connection.getresponse().status != http.HTTPStatus.SERVICE_UNAVAILABLE:
                return
        time.sleep(0.05)


def check_token(token: str) -> str:
    """Return ``token`` if it can stand in an address and a cookie and is too long to be guessed."""
    if re.fullmatch(r"[A-Za-z0-9_-]{16,128}", token):
        return token
    raise Refused(
        f"a token of {len(token)} characters cannot be used; valid are 16 to 128 of the characters A-Z a-z 0-9 _ -"
    )


def start_server(
    *,
    host: str = "127.0.0.1",
    port: int = 8080,
    token: str | None = None,
    on_refused: Callable[[str], None] = lambda _: None,
) -> viser.ViserServer:
    """Start a viser server that only its own page can talk to.

    Host, Origin and token are checked before HTTP requests and websockets alike; the public share tunnel is taken
    out; every message passes :class:`app.door.Door`. Nothing is printed.

    Args:
        host: Address to listen on.
        port: Port to listen on; 0 takes a free one (``server.get_port()`` names it).
        token: Secret that a browser must show, see :func:`check_token`; None for none.
        on_refused: Called on the event loop with a sentence about each value that a browser sent in vain.

    Raises:
        PortBusyError: The port is taken.
        OSError: The address is not one of this machine's.
        RuntimeError: This version of viser has moved what the guard hooks into.
    """
    require_free_port(host, port)
    gate = Gate(host, None if token is None else check_token(token))
    door = Door(on_refused)
    with _gated_serve(gate, door) as calls, contextlib.redirect_stdout(io.StringIO()):
        server = viser.ViserServer(host=host, port=port, verbose=False)
    try:
        _require_gated(server, port, calls)
        _close_share_tunnel(server)
        door.server = server
    except BaseException:
        server.stop()
        raise
    gate.is_open = True
    return server


_serve_lock = threading.Lock()


@contextlib.contextmanager
def _gated_serve(gate: Gate, door: Door) -> Iterator[list[int]]:
    """Put both before every websockets server that is started meanwhile; yields the list of their ports."""
    calls: list[int] = []
    policy = content_security_policy()
    real = websockets.asyncio.server.serve

    def serve(handler: Any, host: Any, port: Any, *, process_request: Callable[..., Any], **options: Any) -> Any:
        def gated(connection: ServerConnection, request: Request) -> Any:
            response = gate.answer(connection, request)
            if response is None:
                response = process_request(connection, request)
            if response is not None:
                response.headers.update(_HEADERS)
                response.headers["Content-Security-Policy"] = policy
            return response

        calls.append(port)
        options |= {"max_size": MAX_MESSAGE, "create_connection": door.connection_class(), "logger": _quiet_logger()}
        options["close_timeout"] = _CLOSE_SECONDS
        return real(handler, host, port, process_request=gated, **options)

    with _serve_lock:
        websockets.asyncio.server.serve = cast("Any", serve)
        try:
            yield calls
        finally:
            websockets.asyncio.server.serve = real


def _require_gated(server: viser.ViserServer, port: int, calls: list[int]) -> None:
    if not calls:
        raise RuntimeError("viser no longer starts its server through websockets.asyncio.server.serve")
    if port not in (0, server.get_port()):  # viser takes the next free one
        raise PortBusyError(f"port {port} is busy; choose another with --port")


def _quiet_logger() -> logging.Logger:
    """Return a logger without the traceback for every connection that ends before it has asked for anything."""
    logger = logging.getLogger("app.guard.websockets")
    logger.addFilter(_is_worth_logging)
    return logger


def _is_worth_logging(record: logging.LogRecord) -> bool:
    return record.getMessage() != "opening handshake failed"


def _close_share_tunnel(server: viser.ViserServer) -> None:
    """Drop the messages with which any browser could open a public tunnel to this server."""
    for message in (_messages.ShareUrlRequest, _messages.ShareUrlDisconnect):
        server._websock_server.unregister_handler(message)
