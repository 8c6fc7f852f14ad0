"""The worker's side of ``benchmarks/peers.py``: answers timing requests, one JSON object a line.

Runs in every engine's own environment, so it needs numpy and nothing else. A fuzzy system arrives as
``{"inputs": [variable], "outputs": [variable], "rules": [[[term name for each input], output term name]]}``, where a
variable is ``{"name", "low", "high", "terms": [[name, kind, parameters]]}`` and every rule joins all inputs by AND.
"""

from __future__ import annotations

import json
import os
import sys
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol

import numpy as np


class Driver(Protocol):
    """One engine behind the five things that are measured. All it calls is the engine's public interface."""

    batches: bool
    """Whether the engine takes many inputs at once."""

    def version(self) -> str:
        """Return the engine's version."""
        ...

    def build(self, system: dict[str, Any]) -> None:
        """Build the engine's own system with min, max, min, max and centroid."""
        ...

    def calls(self, rows: list[list[float]]) -> list[float]:
        """Return the output of one call for each row, the way a user would write the loop."""
        ...

    def batch(self, rows: Any) -> Any:
        """Return the outputs for (n, n_in) rows at once."""
        ...

    def edit(self, rule: int, term: str) -> None:
        """Give one rule another consequent, the quickest way that the engine offers."""
        ...


def serve(driver: Driver) -> None:
    """Answer requests until the input ends."""
    # What an engine prints must not be mistaken for an answer.
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    warnings.simplefilter("ignore")
    np.seterr(all="ignore")
    worker = _Worker(driver)
    for line in sys.stdin:
        request = json.loads(line)
        try:
            answer = getattr(worker, request.pop("do"))(**request)
        except Exception as error:  # noqa: BLE001, RUF100 - whatever an engine raises is a line in the table
            answer = {"error": f"{type(error).__name__}: {error}"}
        answers.write(json.dumps(answer) + "\n")
        answers.flush()


class _Worker:
    def __init__(self, driver: Driver) -> None:
        self.driver = driver
        self.random = np.random.default_rng(0)
        self.system: dict[str, Any] = {}
        self.edits = 0

    def build(self, system: dict[str, Any]) -> dict[str, Any]:
        self.system = system
        self.driver.build(system)
        self.driver.calls(self._rows(1).tolist())
        if self.driver.batches:
            self.driver.batch(self._rows(2))
        return {"version": self.driver.version(), "batches": self.driver.batches}

    def answers(self, rows: list[list[float]]) -> dict[str, Any]:
        return {"values": [float(value) for value in self.driver.calls(rows)]}

    def call(self, budget: float) -> dict[str, Any]:
        return self._timed(budget, lambda n: self._rows(n).tolist(), self.driver.calls, 1, 100_000)

    def batch(self, budget: float, least: int, most: int) -> dict[str, Any]:
        if self.driver.batches:
            return self._timed(budget, self._rows, self.driver.batch, least, most)
        return self._timed(budget, lambda n: self._rows(n).tolist(), self.driver.calls, 1, most)

    def edit(self, budget: float) -> dict[str, Any]:
        return self._timed(budget, lambda n: self._rows(n).tolist(), self._edit_and_call, 1, 1000)

    def memory(self) -> dict[str, Any]:
        """Return the process's greatest resident memory; not of whoever started it, as ``getrusage`` may."""
        status = Path("/proc/self/status")
        if status.is_file():
            line = next(line for line in status.read_text().splitlines() if line.startswith("VmHWM"))
            return {"bytes": 1024 * int(line.split()[1])}
        import resource  # not on Windows

        unit = 1 if sys.platform == "darwin" else 1024
        return {"bytes": unit * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss}

    def _edit_and_call(self, rows: list[list[float]]) -> None:
        terms = [name for name, _, _ in self.system["outputs"][0]["terms"]]
        for row in rows:
            self.edits += 1
            # Never the term that is there: what changes nothing might cost nothing.
            self.driver.edit(self.edits % len(self.system["rules"]), terms[self.edits % len(terms)])
            self.driver.calls([row])

    def _timed(
        self, budget: float, prepare: Callable[[int], Any], run: Callable[[Any], Any], least: int, most: int
    ) -> dict[str, Any]:
        """Run more and more rows until one run fills the budget, and return the last run's seconds a row."""
        count = least
        while True:
            rows = prepare(count)  # fresh ones: some engines remember answers
            begin = time.perf_counter()
            run(rows)
            seconds = time.perf_counter() - begin
            if seconds >= budget / 2 or count >= most:
                return {"seconds": seconds / count, "count": count}
            count = min(most, max(2 * count, int(count * 0.8 * budget / max(seconds, 1e-6))))

    def _rows(self, count: int) -> Any:
        low, high = (np.array([v[end] for v in self.system["inputs"]]) for end in ("low", "high"))
        return np.ascontiguousarray(self.random.uniform(low, high, (count, len(low))))
