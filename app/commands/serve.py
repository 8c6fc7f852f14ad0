"""``serve``: the workbench in the browser."""

from __future__ import annotations

import contextlib
import os
import secrets
import signal
import sys
import threading
from pathlib import Path
from typing import Annotated

import tyro

SHIPPED = Path(__file__).resolve().parents[2] / "rulebases" / "diagonal.yaml"
"""The rule base that is opened where none is named."""


def serve(
    rulebase: tyro.conf.Positional[
        Annotated[Path | None, tyro.conf.arg(metavar="[RULEBASE]", help_behavior_hint="")]
    ] = None,
    /,
    *,
    host: str = "127.0.0.1",
    port: int = 8080,
    token: Annotated[str | None, tyro.conf.arg(metavar="TOKEN", help_behavior_hint="")] = None,
    open_browser: Annotated[bool, tyro.conf.arg(name="open")] = False,
) -> int:
    """Start the workbench; Ctrl+C ends it.

    Args:
        rulebase: The rule base to open; its folder is where the workbench saves. By default rulebases/diagonal.yaml.
        host: Address to listen on. Any other than this machine's own opens the workbench to the network: a token is
            then needed to connect, and made up if none is given.
        port: Port to listen on, 1 to 65535.
        token: Secret that a browser must show, 16 to 128 of the characters A-Z a-z 0-9 _ -.
        open_browser: Open the page in the browser, where there is one.
    """
    from app.commands.failure import UsageError
    from fuzzy.formats import load

    if not 1 <= port <= 65535:
        raise UsageError(f"port {port}; valid are 1 to 65535")
    path = rulebase or SHIPPED
    load(path)

    from app import guard
    from app.clean import Refused

    host = host.strip("[]")
    if token is None and not guard.is_loopback(host):
        token = secrets.token_urlsafe(24)
    try:
        token = token and guard.check_token(token)
    except Refused as error:
        raise UsageError(str(error)) from None
    guard.require_free_port(host, port)
    if not guard.is_loopback(host):
        print(
            f"fuzzy-workbench: warning: listening on {host}: other machines can connect with the address below, and "
            "whoever has it can change and save rule bases; the connection is not encrypted",
            file=sys.stderr,
        )
    address = guard.address(host, port, token)
    threading.Thread(target=_announce, args=(host, port, address, open_browser), daemon=True).start()

    from app.workbench import serve as start

    signal.signal(signal.SIGTERM, _interrupt)
    with contextlib.suppress(KeyboardInterrupt):
        start(path, host=host, port=port, token=token)
    return 0


def _interrupt(*_: object) -> None:
    """End as Ctrl+C does, so that everything is closed on the way out."""
    raise KeyboardInterrupt


def _announce(host: str, port: int, address: str, open_browser: bool) -> None:
    """Print the address as soon as the page is served, and open it."""
    from app import guard

    guard.wait_until_served(host, port)
    print(f"Fuzzy workbench: {address}  (Ctrl+C ends it)", flush=True)
    if open_browser and _has_display():
        import webbrowser

        webbrowser.open(address)


def _has_display() -> bool:
    """Tell whether a browser could be seen; without a display a text browser would take over the terminal."""
    if sys.platform in ("win32", "darwin"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
