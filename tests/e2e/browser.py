"""Find the Chromium that the browser tests drive, and install one where there is none.

``python -m tests.e2e.browser`` is what ``make test`` calls before the tests: on Debian as root it installs the
package ``chromium``, elsewhere Playwright's own build. It never fails: without a browser the tests say so.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

from playwright.sync_api import sync_playwright

MISSING = (
    "The browser tests need Chromium and none was found: install the package chromium, or run "
    "'.venv/bin/playwright install chromium', or let CHROMIUM name an executable."
)

_NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")


def find_chromium() -> str | None:
    """Return the path of a Chromium: $CHROMIUM, one on PATH, or Playwright's own; None where there is none."""
    named = os.environ.get("CHROMIUM")
    if named:
        return shutil.which(named)
    for name in _NAMES:
        found = shutil.which(name)
        if found:
            return found
    with sync_playwright() as playwright:
        own = playwright.chromium.executable_path
    return own if Path(own).is_file() else None


def _install() -> None:
    is_root = hasattr(os, "geteuid") and os.geteuid() == 0
    if is_root and shutil.which("apt-get"):
        _run("apt-get", "-qq", "update")
        if _run("apt-get", "-qq", "install", "--yes", "--no-install-recommends", "chromium"):
            return
    _run(sys.executable, "-m", "playwright", "install", "chromium")


def _run(*command: str) -> bool:
    """Run a command quietly; show what it said only when it failed."""
    environment = os.environ | {"DEBIAN_FRONTEND": "noninteractive"}
    done = subprocess.run(
        command,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        check=False,
    )
    if done.returncode:
        print(f"{' '.join(command)}: exit code {done.returncode}", file=sys.stderr)
        print(done.stdout.decode(errors="replace")[-2000:], file=sys.stderr)
    return done.returncode == 0


def main() -> None:
    """Make sure that there is a Chromium, as far as this machine allows."""
    if find_chromium() is None and not os.environ.get("CHROMIUM"):
        print("Installing Chromium for the browser tests (once) ...", flush=True)
        _install()
    if find_chromium() is None:
        print(MISSING, file=sys.stderr)


if __name__ == "__main__":
    main()
