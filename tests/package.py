"""Builds the wheel, installs it into an empty environment and tries it outside the checkout: ``make package``."""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import socket
import subprocess
import sys
import sysconfig
import tempfile
import time
import urllib.request
from pathlib import Path

ROOT = Path(__file__).parents[1]
SOURCES = ("app", "fuzzy", "robot", "rulebases", "pyproject.toml", "README.md")
PATIENCE = 60.0


def build(place: Path, *, is_isolated: bool) -> Path:
    """Return the wheel, built from a copy of the sources; isolated, what builds it is fetched anew."""
    copy = place / "sources"
    copy.mkdir()
    for name in SOURCES:
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(ROOT / name, copy / name)
    isolation = [] if is_isolated else ["--no-build-isolation"]
    _run(sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", *isolation, "-w", place / "dist", copy)
    (wheel,) = (place / "dist").glob("*.whl")
    return wheel


def install(wheel: Path, place: Path, *, has_dependencies: bool) -> Path:
    """Return the folder of programs of an empty environment with the wheel in it.

    Args:
        wheel: The wheel.
        place: Where the environment is made.
        has_dependencies: Whether what the wheel needs is fetched too; otherwise this environment's own is used.
    """
    _run(sys.executable, "-m", "venv", "--without-pip", place)
    python = place / "bin" / "python"
    options = [] if has_dependencies else ["--no-deps"]
    _run(sys.executable, "-m", "pip", "--python", python, "install", "-q", *options, wheel)
    if not has_dependencies:
        (packages,) = place.glob("lib/python*/site-packages")
        (packages / "borrowed.pth").write_text(sysconfig.get_path("purelib") + "\n")
    return python.parent


def try_out(programs: Path, place: Path, *, has_kernels: bool) -> None:
    """Use the installed program as somebody would who has no checkout.

    Args:
        programs: The environment's folder of programs.
        place: Where it is used.
        has_kernels: Whether to wait for kernels to be compiled too.

    Raises:
        AssertionError: It does not do what it should.
    """
    place.mkdir(exist_ok=True)
    names = ("XDG_DATA_HOME", "XDG_STATE_HOME", "XDG_CONFIG_HOME")
    surroundings = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "VIRTUAL_ENV")}
    surroundings |= {name: str(place / name.lower()) for name in names}

    def run(*words: str | Path) -> str:
        return _run(*words, cwd=place, env=surroundings)

    look = "import app, fuzzy, robot; robot.Arm.preset('stiff'), robot.Scenario.preset('circle')"
    for file in run(programs / "python", "-c", f"{look}; print(app.__file__, fuzzy.__file__, robot.__file__)").split():
        assert Path(file).is_relative_to(programs.parent), file
    program = programs / "fuzzy-workbench"

    with socket.create_server(("127.0.0.1", 0)) as probe:
        port = probe.getsockname()[1]
    # Its own folder is read-only, as where a package manager has installed it.
    (shipped,) = programs.parent.glob("lib/python*/site-packages/rulebases")
    shipped.chmod(0o555)
    log = place / "serve.log"
    with log.open("wb") as output:
        command = [program, "serve", "--port", str(port)]
        process = subprocess.Popen(command, cwd=place, env=surroundings, stdout=output, stderr=subprocess.STDOUT)
    try:
        deadline = time.monotonic() + PATIENCE
        status = 0
        while status != 200 or "Ctrl+C ends it" not in log.read_text():  # the page is served before that is printed
            assert process.poll() is None, log.read_text()
            assert time.monotonic() < deadline, log.read_text()
            time.sleep(0.1)
            with contextlib.suppress(OSError), urllib.request.urlopen(f"http://127.0.0.1:{port}", timeout=5) as answer:
                status = answer.status
    finally:
        process.send_signal(signal.SIGTERM)
    assert process.wait(timeout=PATIENCE) == 0, log.read_text()
    own = place / "xdg_data_home" / "fuzzy-workbench" / "rulebases"
    assert {"diagonal.yaml", "piltan.yaml"} <= {file.name for file in own.iterdir()}
    assert str(own) in log.read_text()
    if has_kernels:
        run(program, "check", own / "diagonal.yaml")


def _run(*words: str | Path, cwd: Path = ROOT, env: dict[str, str] | None = None) -> str:
    done = subprocess.run([str(word) for word in words], cwd=cwd, env=env, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{' '.join(map(str, words))}:\n{done.stdout}{done.stderr}"
    return done.stdout


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        wheel = build(place, is_isolated=True)
        print(f"built {wheel.name}, {wheel.stat().st_size // 1024} KiB; installing it with all that it needs ...")
        programs = install(wheel, place / "environment", has_dependencies=True)
        try_out(programs, place / "elsewhere", has_kernels=True)
        print("the installed program works outside the checkout")
