"""``serve``: the workbench in the browser."""

from __future__ import annotations

import logging
import os
import secrets
import signal
import sys
import threading
import time
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import tyro

if TYPE_CHECKING:
    from app.workbench import Workbench

_log = logging.getLogger(__name__)

_LISTEN_SECONDS = 0.2
_MOST_SECONDS = 1.5
"""How long the end may take, from the moment in which unsaved work is safe."""


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
    log_level: Literal["debug", "info", "warning", "error"] = "info",
    log_file: Annotated[Path | None, tyro.conf.arg(metavar="FILE", help_behavior_hint="")] = None,
) -> int:
    """Start the workbench; Ctrl+C ends it, and keeps unsaved work for the next start.

    Args:
        rulebase: The rule base to open; its folder is where the workbench saves. By default rulebases/diagonal.yaml;
            an installed program copies it to ~/.local/share/fuzzy-workbench/rulebases first.
        host: Address to listen on. Any other than this machine's own opens the workbench to the network: a token is
            then needed to connect, and made up if none is given.
        port: Port to listen on, 1 to 65535.
        token: Secret that a browser must show, 16 to 128 of the characters A-Z a-z 0-9 _ -.
        open_browser: Open the page in the browser, where there is one.
        log_level: What is logged to standard error: one line for every event of this weight or more.
        log_file: Where the same is logged too. At 10 MiB it begins anew; the two files before it are kept.
    """
    from app import logs
    from app.commands.failure import UsageError
    from app.shipped import editable
    from fuzzy.formats import load

    if not 1 <= port <= 65535:
        raise UsageError(f"port {port}; valid are 1 to 65535")
    logs.configure(log_level, log_file)
    path = rulebase or editable()
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

    from app.workbench import Workbench

    signal.signal(signal.SIGTERM, _interrupt)
    workbench: Workbench | None = None
    try:
        workbench = Workbench(path, host=host, port=port, token=token)
        _log.info("started: %s on %s:%d, version %s", path.resolve(), host, port, version("fuzzy-arm-workbench"))
        while True:  # a signal that comes just before a sleep is heard after it
            time.sleep(_LISTEN_SECONDS)
    except KeyboardInterrupt:
        pass
    if workbench is not None:
        _end(workbench)
    return 0


def _end(workbench: Workbench) -> None:
    """Keep unsaved work, then end; whatever does not end in time ends with the process."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)
    state = workbench.store.state
    is_kept = workbench.keep_work()
    if state.work.is_unsaved:
        what = "are kept, and offered at the next start with the same folder" if is_kept else "could not be kept"
        print(f"fuzzy-workbench: unsaved edits of {state.file} {what}", file=sys.stderr, flush=True)
    _log.info("ended")
    late = threading.Timer(_MOST_SECONDS, os._exit, (0,))
    late.daemon = True
    late.start()
    workbench.stop()


def _interrupt(*_: object) -> None:
    """End as Ctrl+C does, so that everything is closed on the way out."""
    raise KeyboardInterrupt


def _announce(host: str, port: int, address: str, open_browser: bool) -> None:
    """Print the address as soon as the page is served, and open it."""
    from app import guard

    guard.wait_until_served(host, port)
    print(f"Fuzzy workbench: {address}  (Ctrl+C ends it)", flush=True)
    if open_browser and has_display():
        import webbrowser

        webbrowser.open(address)


def has_display() -> bool:
    """Tell whether a browser could be seen; without a display a text browser would take over the terminal."""
    if sys.platform in ("win32", "darwin"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
