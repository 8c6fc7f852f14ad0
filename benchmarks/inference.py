"""How fast the 49 rules of rulebases/diagonal.yaml are inferred, compiled and explained.

Times are the least of many rounds, which is what the machine can do when nothing else runs; ratios within one round
say more on a busy machine.
"""

from __future__ import annotations

import functools
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
import numpy as np
from msgspec.structs import replace

from fuzzy import compile_system, load
from fuzzy.compiler import compile_tables
from fuzzy.kernels.inference import compiled_call, evaluate_rows
from fuzzy.shapes import Gaussian
from fuzzy.system import FuzzySystem, Inference, RuleBase, Sampling

CALLS = 1_000
ROWS = 100_000


@numba.njit
def empty(address, first, second):
    """Next to nothing: what numba needs to call anything with these arguments."""
    return address + first + second


def main() -> None:
    system = load(Path(__file__).parents[1] / "rulebases" / "diagonal.yaml")
    controller = compile_system(system)
    own = controller.directory()
    address = own.address
    entry = compiled_call(2)
    x = np.random.default_rng(0).uniform(-1, 1, (ROWS, 2)) * [variable.high for variable in system.inputs]
    y = np.zeros((ROWS, 1))

    bare, kernel, call = _least(
        lambda: [empty(address, 0.2, -1.0) for _ in range(CALLS)],
        lambda: [entry(address, (0.2, -1.0)) for _ in range(CALLS)],
        lambda: [controller(0.2, -1.0) for _ in range(CALLS)],
        rounds=300,
    )
    print(f"one call from Python         {1e6 * call / CALLS:8.3f} µs   {call / bare:.2f} times an empty numba call")
    print(f"  its kernel                 {1e6 * kernel / CALLS:8.3f} µs   {kernel / bare:.2f} times")
    inside, batch = _least(lambda: evaluate_rows(address, x, y, 0, ROWS), lambda: controller.batch(x), rounds=60)
    print(f"inside another kernel        {1e6 * inside / ROWS:8.3f} µs   random inputs, one thread")
    rate = 1e-6 * ROWS / batch
    print(f"batch of {ROWS:,}           {rate:8.1f} million a second, {inside / batch:.2f} times one thread")

    painted = _painted(system)
    tables, edit, explain = _least(
        lambda: [compile_tables(each) for each in painted],
        lambda: [compile_system(each)(0.2, -1.0) for each in painted],
        lambda: [controller.explain(0.2, -1.0) for _ in painted],
        rounds=40,
    )
    print(f"tables after one cell        {1e6 * tables / len(painted):8.1f} µs")
    print(f"validate, compile, call      {1e6 * edit / len(painted):8.1f} µs   after one cell")
    print(f"explain                      {1e6 * explain / len(painted):8.1f} µs")

    print("other methods, inside another kernel:")
    for name, other in _others(system).items():
        own = compile_system(other).directory()
        rows = ROWS // 100
        (taken,) = _least(functools.partial(evaluate_rows, own.address, x, y, 0, rows), rounds=60)
        print(f"  {name:26} {1e6 * taken / rows:8.3f} µs")


def _least(*works: Callable[[], Any], rounds: int) -> list[float]:
    """Return the least time of each work over several rounds in which they take turns, in s."""
    for work in works:
        work()  # compiles
    times = np.empty((rounds, len(works)))
    for row in times:
        for column, work in enumerate(works):
            start = time.perf_counter()
            work()
            row[column] = time.perf_counter() - start
    return times.min(axis=0).tolist()


def _painted(system: FuzzySystem) -> list[FuzzySystem]:
    """Return the system with each cell of its table changed in turn."""
    table = system.rules.table
    assert table is not None
    found = []
    for i, row in enumerate(table.cells):
        for j in range(len(row)):
            changed = (*row[:j], "Z" if row[j] != "Z" else "SR", *row[j + 1 :])
            cells = (*table.cells[:i], changed, *table.cells[i + 1 :])
            found.append(replace(system, rules=RuleBase(replace(table, cells=cells))))
    return found


def _others(system: FuzzySystem) -> dict[str, FuzzySystem]:
    (output,) = system.outputs
    step = (output.high - output.low) / (len(output.terms) - 1)
    curved = tuple(
        replace(term, shape=Gaussian(output.low + k * step, step / 2.5)) for k, term in enumerate(output.terms)
    )
    return {
        "product, max": replace(system, inference=Inference(implication="product")),
        "min, sum": replace(system, inference=Inference(aggregation="sum")),
        "product, sum": replace(system, inference=Inference(implication="product", aggregation="sum")),
        "101 samples": replace(system, inference=Inference(resolution=Sampling(101, "endpoints"))),
        "Gaussian output sets": replace(system, outputs=(replace(output, terms=curved),)),
    }


if __name__ == "__main__":
    main()
