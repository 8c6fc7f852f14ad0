"""Other fuzzy engines on the same work: one call, a batch, an edit and a call, memory, and how far they are off.

Every engine runs in a process and an environment of its own (pyfuzzylite needs numpy < 2), made on the first run
below the user's cache folder or where ``--environments`` says. The rounds are interleaved: every engine once, then
every engine again, so that whatever else the machine does meets all of them; ratios are medians over the rounds.
"""

from __future__ import annotations

import argparse
import json
import math
import queue
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import fuzzy
from fuzzy import rules, shapes
from fuzzy.kernels.jit import cache_root
from fuzzy.system import FuzzySystem, Input, Output

_ROOT = Path(__file__).parents[1]
_DRIVERS = Path(__file__).parent / "drivers"
_INSTALL_SECONDS = 180.0
_COMPILE_SECONDS = 300.0
_PATIENCE = 20.0
_LEAST_ROWS = 20

_GAUSSIAN_INPUTS = 4
_GAUSSIAN_RULES = 300


class Engine(NamedTuple):
    """An engine to compare."""

    name: str
    driver: str
    requirements: tuple[str, ...]  # none: this project's own environment
    most_rows: int  # in one batch; where memory or patience does not bear 100,000 it is extrapolated


ENGINES = (
    Engine("workbench", "drive_workbench.py", (), 100_000),
    Engine("ferrifuzz", "drive_ferrifuzz.py", ("ferrifuzz", "numpy"), 100_000),
    Engine("pyfuzzylite", "drive_pyfuzzylite.py", ("pyfuzzylite",), 2_000),
    Engine("simpful", "drive_simpful.py", ("simpful",), 100),
    Engine("scikit-fuzzy", "drive_skfuzzy.py", ("scikit-fuzzy", "numpy", "scipy", "networkx", "packaging"), 1_000),
)


class Load(NamedTuple):
    """One system, how often and how long it is measured, and where the answers are compared."""

    title: str
    system: dict[str, Any]
    rounds: int
    seconds: float
    places: list[list[float]]


class Figures(NamedTuple):
    """What was measured of one engine, one entry a round; times in seconds."""

    call: list[float]
    batch: list[float]
    edit: list[float]
    rows: list[int]  # in the batches


class EngineError(RuntimeError):
    """An engine that cannot be installed, does not answer in time, or refuses the work."""


def main(words: list[str] | None = None) -> None:
    """Print one table for each system."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--environments", type=Path, default=cache_root().parent / "peers", metavar="FOLDER")
    parser.add_argument("--patience", type=float, default=_PATIENCE, metavar="SECONDS", help="for one answer")
    options = parser.parse_args(words or [])
    with ThreadPoolExecutor() as pool:
        pythons = list(pool.map(lambda engine: _python(engine, options.environments), ENGINES))
    for load in _loads():
        comparison = _Comparison(load, options.patience)
        comparison.run(pythons)
        _print(comparison)
    print("\n×: how many times our time. *: one call after another, for want of a batch. README.md says more.")


def _python(engine: Engine, folder: Path) -> Path | str:
    """Return the interpreter of an engine's environment, made where it is missing; or why there is none."""
    if not engine.requirements:
        return Path(sys.executable)
    home = folder / f"{engine.name}-{sys.version_info[0]}.{sys.version_info[1]}"
    python = home / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")
    complete = home / "complete"
    if complete.is_file() and complete.read_text() == " ".join(engine.requirements) and python.exists():
        return python
    install = (str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-input")
    patience = ("--retries", "1", "--timeout", "15", "--only-binary", ":all:")
    try:
        for command in (
            (sys.executable, "-m", "venv", "--clear", str(home)),
            (*install, *patience, *engine.requirements),
        ):
            subprocess.run(command, check=True, capture_output=True, text=True, timeout=_INSTALL_SECONDS)
    except subprocess.CalledProcessError as error:
        return f"cannot be installed: {_last_line(error.stderr or error.stdout)}"
    except subprocess.TimeoutExpired:
        return f"cannot be installed: nothing after {_INSTALL_SECONDS:g} s"
    except OSError as error:
        return f"cannot be installed: {error}"
    complete.write_text(" ".join(engine.requirements))
    return python


class _Worker:
    """An engine's process."""

    def __init__(self, engine: Engine, python: Path) -> None:
        self._errors = tempfile.TemporaryFile(mode="w+")  # noqa: SIM115 - closed by stop()
        self._process = subprocess.Popen(
            [str(python), str(_DRIVERS / engine.driver)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
            text=True,
        )
        self._answers: queue.Queue[str] = queue.Queue()
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        if self._process.stdout:
            for line in self._process.stdout:
                self._answers.put(line)
        self._answers.put("")

    def ask(self, do: str, seconds: float, **details: Any) -> dict[str, Any]:
        """Return the answer to a request.

        Raises:
            EngineError: The engine's own error, or no answer in time; then the process is ended.
        """
        try:
            if self._process.stdin:
                self._process.stdin.write(json.dumps({"do": do, **details}) + "\n")
                self._process.stdin.flush()
            line = self._answers.get(timeout=seconds)
        except queue.Empty:
            self.stop()
            raise EngineError(f"{do}: no answer within {seconds:g} s") from None
        except OSError:
            line = ""
        if not line:
            self._errors.seek(0)
            raise EngineError(f"{do}: the process ended: {_last_line(self._errors.read())}")
        answer = json.loads(line)
        if "error" in answer:
            raise EngineError(f"{do}: {answer['error']}")
        return answer

    def stop(self) -> None:
        """End the process."""
        self._process.kill()
        self._process.wait()
        for stream in (self._process.stdin, self._errors):
            if stream and not stream.closed:
                try:
                    stream.close()
                except BrokenPipeError:  # what was not yet read by a process that has ended
                    continue


class _Comparison:
    """All engines on one load."""

    def __init__(self, load: Load, patience: float) -> None:
        self.load = load
        self.patience = patience
        self.workers: dict[Engine, _Worker] = {}
        self.remarks: dict[Engine, str] = {}
        self.figures = {engine: Figures([], [], [], []) for engine in ENGINES}
        self.facts: dict[Engine, dict[str, Any]] = {}
        self.answers: dict[Engine, Any] = {}
        self.spent = dict.fromkeys(ENGINES, 0.0)

    def run(self, pythons: list[Path | str]) -> None:
        """Measure every engine that can be had."""
        try:
            for engine, python in zip(ENGINES, pythons, strict=True):
                if isinstance(python, str):
                    self.remarks[engine] = python
                    continue
                self.workers[engine] = _Worker(engine, python)
                self._attempt(engine, self._begin)
            # Edits last: they change the rules, and with other rules a call costs something else.
            for work, rounds in ((self._measure, self.load.rounds), (self._end, 1), (self._edit, self.load.rounds)):
                self.spent = dict.fromkeys(ENGINES, 0.0)
                for _ in range(rounds):
                    for engine in list(self.workers):
                        # A slow engine sits out the later rounds; the ratios of the first ones count.
                        if self.spent[engine] < self.patience / 4:
                            self._attempt(engine, work)
        finally:
            for worker in self.workers.values():
                worker.stop()

    def _attempt(self, engine: Engine, work: Callable[[Engine, _Worker], None]) -> None:
        begin = time.perf_counter()
        try:
            work(engine, self.workers[engine])
        except EngineError as error:
            self.remarks[engine] = str(error)
            self.workers.pop(engine).stop()
        self.spent[engine] += time.perf_counter() - begin

    def _begin(self, engine: Engine, worker: _Worker) -> None:
        # Building this project's engine for the first time compiles its kernels.
        patience = self.patience if engine.requirements else _COMPILE_SECONDS
        self.facts[engine] = worker.ask("build", patience, system=self.load.system)
        self.answers[engine] = np.array(worker.ask("answers", self.patience, rows=self.load.places)["values"])

    def _measure(self, engine: Engine, worker: _Worker) -> None:
        found, budget = self.figures[engine], self.load.seconds
        found.call.append(worker.ask("call", self.patience, budget=budget)["seconds"])
        batch = worker.ask("batch", self.patience, budget=budget, least=_LEAST_ROWS, most=engine.most_rows)
        found.batch.append(batch["seconds"])
        found.rows.append(batch["count"])

    def _end(self, engine: Engine, worker: _Worker) -> None:
        self.facts[engine]["memory"] = worker.ask("memory", self.patience)["bytes"]

    def _edit(self, engine: Engine, worker: _Worker) -> None:
        self.figures[engine].edit.append(worker.ask("edit", self.patience, budget=self.load.seconds)["seconds"])


def _print(comparison: _Comparison) -> None:
    print(f"\n{comparison.load.title}")
    print(
        f"{'engine':13}{'version':9}{'one call':>10}{'×':>10}{'row of a batch':>16}{'×':>10}{'rows':>9}"
        f"{'edit, call':>12}{'×':>10}{'memory':>9}{'off by':>12}{'undefined':>11}"
    )
    ours = comparison.figures[ENGINES[0]]
    output = comparison.load.system["outputs"][0]
    exact = comparison.answers.get(ENGINES[0])
    for engine in ENGINES:
        found, facts = comparison.figures[engine], comparison.facts.get(engine, {})
        remark = comparison.remarks.get(engine, "")
        if "memory" not in facts:
            print(f"{engine.name:13}{remark}")
            continue
        off, undefined = "", ""
        if exact is not None:
            error = abs(comparison.answers[engine] - exact) / (output["high"] - output["low"])
            off = f"{100 * np.nanmax(error):.3g} %"
            undefined = f"{np.isnan(error).sum()}/{error.size}"
        rows = f"{max(found.rows)}" + ("" if facts["batches"] else "*")
        print(
            f"{engine.name:13}{facts['version']:9}"
            f"{_time(found.call):>10}{_ratio(found.call, ours.call):>10}"
            f"{_time(found.batch):>16}{_ratio(found.batch, ours.batch):>10}{rows:>9}"
            f"{_time(found.edit):>12}{_ratio(found.edit, ours.edit):>10}"
            f"{facts['memory'] / 1e6:>6.0f} MB{off:>12}{undefined:>11}{'  ' + remark if remark else ''}"
        )


def _time(seconds: list[float]) -> str:
    if not seconds:
        return "-"
    middle = statistics.median(seconds)
    for unit, factor in (("ns", 1e9), ("µs", 1e6), ("ms", 1e3)):
        if middle * factor < 1000:
            return f"{middle * factor:.3g} {unit}"
    return f"{middle:.3g} s"


def _ratio(theirs: list[float], ours: list[float]) -> str:
    ratios = [a / b for a, b in zip(theirs, ours, strict=False)]  # of the rounds that both took part in
    return f"{statistics.median(ratios):.3g}" if ratios else "-"


def _last_line(text: str) -> str:
    lines = [line for line in text.strip().splitlines() if line.strip()]
    return lines[-1][:200] if lines else "without a word"


def _loads() -> list[Load]:
    table = _encoded(fuzzy.load(_ROOT / "rulebases" / "diagonal.yaml"))
    curved = _gaussian_system()
    random = np.random.default_rng(2)
    # Anywhere, not on an even grid: there, the places fall on break points, where sampling happens to be exact.
    low, high = ([v[end] for v in table["inputs"]] for end in ("low", "high"))
    places = [low, high, [0.0, 0.0], *random.uniform(low, high, (120, 2)).tolist()]
    return [
        Load("49 rules, e and ė → T: triangles, a full table (rulebases/diagonal.yaml)", table, 5, 0.2, places),
        Load(
            f"{_GAUSSIAN_RULES} rules in a list, {_GAUSSIAN_INPUTS} inputs → 1 output: Gaussian sets",
            curved,
            3,
            0.2,
            random.uniform(0.0, 1.0, (10, _GAUSSIAN_INPUTS)).tolist(),
        ),
    ]


def _encoded(system: FuzzySystem) -> dict[str, Any]:
    """Return a system of AND rules as the drivers read it, see ``drivers/protocol.py``."""
    order = [variable.name for variable in system.inputs]
    encoded = []
    for rule in rules.all_rules(system):
        terms = {proposition.variable: proposition.term for proposition in rules.propositions(rule.antecedent)}
        encoded.append([[terms[name] for name in order], rule.consequents[0].term])
    return {
        "inputs": [_variable(variable) for variable in system.inputs],
        "outputs": [_variable(variable) for variable in system.outputs],
        "rules": encoded,
    }


def _variable(variable: Input | Output) -> dict[str, Any]:
    terms = []
    for term in variable.terms:
        # Open shoulders, which most engines lack, end one range further out: within the range that is the same.
        width = variable.high - variable.low
        ends = [
            value
            if math.isfinite(value)
            else math.copysign(width, value) + (variable.low if value < 0 else variable.high)
            for value in shapes.parameters(term.shape)
        ]
        terms.append([term.name, shapes.kind(term.shape), ends])
    return {"name": variable.name, "low": variable.low, "high": variable.high, "terms": terms}


def _gaussian_system() -> dict[str, Any]:
    """Return a system that is the same on every run: five sets an input, seven of the output, rules drawn once."""
    random = np.random.default_rng(1)

    def variable(name: str, count: int) -> dict[str, Any]:
        means = np.linspace(0.0, 1.0, count).tolist()
        sigma = 0.4 / (count - 1)
        return {
            "name": name,
            "low": 0.0,
            "high": 1.0,
            "terms": [[f"t{n}", "gaussian", [mean, sigma]] for n, mean in enumerate(means)],
        }

    inputs = [variable(f"x{n}", 5) for n in range(_GAUSSIAN_INPUTS)]
    chosen = random.choice(5**_GAUSSIAN_INPUTS, _GAUSSIAN_RULES, replace=False)
    found = []
    for number in chosen.tolist():
        digits = [number // 5**k % 5 for k in range(_GAUSSIAN_INPUTS)]
        found.append([[f"t{digit}" for digit in digits], f"t{round(sum(digits) * 6 / (4 * _GAUSSIAN_INPUTS))}"])
    return {"inputs": inputs, "outputs": [variable("y", 7)], "rules": found}


if __name__ == "__main__":
    main(sys.argv[1:])
