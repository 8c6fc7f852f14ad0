"""``doctor``: what the program found on this machine, and what to do about it."""

from __future__ import annotations

import os
import platform
import socket
import tempfile
import time
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, requires, version
from pathlib import Path
from typing import Literal

import msgspec

Level = Literal["ok", "problem"]

_PORT = 8080


class Diagnosis(msgspec.Struct, frozen=True):
    """One thing that was looked at.

    Attributes:
        what: What it is.
        found: What was found.
        level: Whether that is as it should be.
        advice: What to do about it; empty where there is nothing to do.
    """

    what: str
    found: str
    level: Level = "ok"
    advice: str = ""


def doctor(*, json: bool = False) -> int:
    """Look at this machine: versions, compiled kernels, permissions, unsaved work, port and browser.

    Says for every problem what to do about it. Exit code 1 when there is one.

    Args:
        json: Print the findings as JSON.
    """
    found = list(_examine())
    if json:
        print(msgspec.json.format(msgspec.json.encode(found)).decode())
    else:
        width = max(len(one.what) for one in found)
        for one in found:
            print(f"{'  ' if one.level == 'ok' else '! '}{one.what:<{width}}  {one.found}")
            if one.advice:
                print(f"{'':<{width + 4}}→ {one.advice}")
    return 1 if any(one.level == "problem" for one in found) else 0


def _examine() -> Iterator[Diagnosis]:
    from app import journal
    from app.shipped import SHIPPED, is_checkout, own_folder
    from fuzzy.kernels import jit

    yield _python()
    yield from _packages()
    yield _kernels(Path(os.environ.get("NUMBA_CACHE_DIR") or jit.cache_root()))
    yield _writable("journals", journal.folder(), "unsaved work would not survive a crash: set XDG_STATE_HOME")
    yield _left(journal.folder())
    rulebases = SHIPPED.parent if is_checkout() else own_folder()
    yield _writable("rule bases", rulebases, "the workbench could not save there: give it a file in a folder of yours")
    yield _port()
    yield _browser()


def _python() -> Diagnosis:
    found = f"{platform.python_version()} on {platform.system()} {platform.machine()}, {os.cpu_count()} cores"
    return Diagnosis("Python", found)


def _packages() -> Iterator[Diagnosis]:
    try:
        needed = requires("fuzzy-arm-workbench") or []
        yield Diagnosis("fuzzy-arm-workbench", version("fuzzy-arm-workbench"))
    except PackageNotFoundError:
        yield Diagnosis("fuzzy-arm-workbench", "not installed", "problem", "make install, or pip install .")
        return
    for line in needed:
        name = line.split(";")[0].strip()
        if "extra ==" in line:
            continue
        name = name[: next((n for n, character in enumerate(name) if character in "<>=!~ ["), len(name))]
        try:
            yield Diagnosis(name, version(name))
        except PackageNotFoundError:
            yield Diagnosis(name, "not installed", "problem", f"pip install '{line}'")


def _kernels(folder: Path) -> Diagnosis:
    files = list(folder.rglob("*.nbc")) if folder.is_dir() else []
    if not _can_write(folder):
        advice = "kernels are compiled at every start, a minute or two: set XDG_CACHE_HOME or NUMBA_CACHE_DIR"
        return Diagnosis("compiled kernels", f"{folder} cannot be written", "problem", advice)
    if not files:
        return Diagnosis("compiled kernels", f"none yet in {folder}", advice="the first start takes a minute or two")
    size = sum(path.stat().st_size for path in files) / 2**20
    return Diagnosis("compiled kernels", f"{len(files)} in {folder}, {size:.1f} MiB")


def _writable(what: str, folder: Path, consequence: str) -> Diagnosis:
    if _can_write(folder):
        return Diagnosis(what, str(folder))
    return Diagnosis(what, f"{folder} cannot be written", "problem", consequence)


def _can_write(folder: Path) -> bool:
    """Tell whether files can be written to a folder, or to the one in which it would be made."""
    existing = next(place for place in (folder, *folder.parents) if place.exists())
    try:
        with tempfile.TemporaryFile(dir=existing) as file:
            file.write(b"x")
    except OSError:
        return False
    return True


def _left(folder: Path) -> Diagnosis:
    journals = sorted(folder.glob("[!.]*.journal"), key=lambda path: path.stat().st_mtime)
    if not journals:
        return Diagnosis("unsaved work", "none")
    when = time.strftime("%Y-%m-%d %H:%M", time.localtime(journals[-1].stat().st_mtime))
    found = f"{len(journals)} journals, the newest of {when}"
    return Diagnosis("unsaved work", found, advice="it is offered when its folder is opened the next time")


def _port() -> Diagnosis:
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(("127.0.0.1", _PORT))
        except OSError:
            advice = "another program, or another workbench, uses it: choose another with --port"
            return Diagnosis(f"port {_PORT}", "busy", "problem", advice)
    return Diagnosis(f"port {_PORT}", "free")


def _browser() -> Diagnosis:
    import webbrowser

    from app.commands.serve import has_display

    try:
        name = webbrowser.get().__class__.__name__ if has_display() else None
    except webbrowser.Error:
        name = None
    if name is None:
        advice = "open the address that serve prints in a browser with WebGL 2, here or through an SSH tunnel"
        return Diagnosis("browser", "none on this machine", advice=advice)
    return Diagnosis("browser", name)
