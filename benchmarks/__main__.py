"""``make bench``: every benchmark of this folder in turn, after what is known of the machine.

A benchmark is a module here with a function ``main()`` that prints its figures. Words on the command line choose
some of them: ``python -m benchmarks inference``.
"""

from __future__ import annotations

import importlib
import os
import platform
import sys
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path


def names() -> list[str]:
    """Return the names of all benchmarks."""
    return sorted(path.stem for path in Path(__file__).parent.glob("*.py") if not path.stem.startswith("_"))


def main(words: list[str]) -> int:
    """Run the benchmarks that ``words`` name, all by default; return the exit code."""
    unknown = [word for word in words if word not in names()]
    if unknown:
        print(f"no benchmark is called {', '.join(unknown)}; valid: {', '.join(names())}", file=sys.stderr)
        return 2
    _print_machine()
    for name in words or names():
        print(f"\n== {name}", flush=True)
        importlib.import_module(f"benchmarks.{name}").main()
    return 0


def _print_machine() -> None:
    packages = ", ".join(f"{name} {metadata.version(name)}" for name in ("numpy", "numba", "viser"))
    print(f"{datetime.now(UTC):%Y-%m-%d %H:%M} UTC  {platform.platform()}")
    print(f"{_processor()}, {len(_usable_cores())} usable cores")
    print(f"Python {platform.python_version()}, {packages}")


def _usable_cores() -> set[int]:
    if hasattr(os, "sched_getaffinity"):
        return os.sched_getaffinity(0)
    return set(range(os.cpu_count() or 1))


def _processor() -> str:
    """Return the processor's name as Linux writes it, or what Python knows of it."""
    description = Path("/proc/cpuinfo")
    if description.is_file():
        for line in description.read_text(encoding="utf-8", errors="replace").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
