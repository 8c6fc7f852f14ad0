"""How fast the closed loop runs: µs a control step (1 ms), against laws, number of modules and size of a batch.

Run as ``python benchmarks/closed_loop.py`` from the repository's root, on an idle machine.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable
from pathlib import Path

import msgspec

sys.path.insert(0, str(Path(__file__).parents[1]))

import fuzzy
from fuzzy.inference import Controller
from robot import controllers, dynamics, experiments
from robot.arm import Arm
from robot.batch import batch_simulate
from robot.robustness import random_arms
from robot.scenario import STEP, Scenario
from robot.simulation import simulate

ROOT = Path(__file__).parents[1]


def main(repeats: int = 20) -> None:
    """Print one line for every law and arm, number of modules, and size of a batch; set-up and logging included."""
    inference = fuzzy.compile_system(fuzzy.load(ROOT / "rulebases" / "diagonal.yaml"))
    laws(inference, repeats)
    modules(inference, repeats)
    batches(inference)


def laws(inference: Controller, repeats: int) -> None:
    scenario = Scenario.preset("step")
    print(f"{'arm':8}{'controller':20}{'µs/step':>10}{'× real time':>14}   (first call: s)")
    for arm_name in ("soft", "stiff"):
        arm = Arm.preset(arm_name)
        for name in controllers.NAMES:
            law = controllers.default(name, arm, scenario, inference)
            first = best_of(1, lambda arm=arm, law=law: simulate(arm, law, scenario))
            best = best_of(repeats, lambda arm=arm, law=law: simulate(arm, law, scenario))
            speed = scenario.duration / best
            print(f"{arm_name:8}{name:20}{best / (scenario.n_steps + 1) * 1e6:10.2f}{speed:14.0f}   ({first:.3g})")


def modules(inference: Controller, repeats: int) -> None:
    scenario = Scenario.preset("step")
    # The longest arms are faster in their fastest motion: the kernel then makes two Runge-Kutta steps a control step.
    print(f"\n{'modules':8}{'pid':>10}{'pd_flc':>10}{'fuzzy_flc':>12}   µs/step")
    for n in range(1, 9):
        # The soft arm's middle module, n times, with springs that carry what hangs below.
        arm = Arm(
            mass=[0.25] * n,
            rod_length=0.08,
            rest_length=0.11,
            stiffness=[[200.0 * max(1.0, n / 3)] * n] * 2,
            damping=[[4.0] * n] * 2,
        )
        line = f"{n:<8}"
        for name, width in (("pid", 10), ("pd_flc", 10), ("fuzzy_flc", 12)):
            law = controllers.default(name, arm, scenario, inference)
            best = best_of(repeats, lambda arm=arm, law=law: simulate(arm, law, scenario))
            line += f"{best / (scenario.n_steps + 1) * 1e6:{width}.2f}"
        print(f"{line}   ({dynamics.substeps(arm, STEP)} Runge-Kutta steps)")


def batches(inference: Controller) -> None:
    scenario = msgspec.structs.replace(Scenario.preset("step"), prefilter=12.0)
    print(f"\n{'batch':8}{'pid':>10}{'fuzzy_flc':>12}   million arm-steps/s on {os.cpu_count()} cores")
    for size in (1, 10, 100, 1000):
        arms = random_arms(experiments.arm(), size)
        line = f"{size:<8}"
        for name, width in (("pid", 10), ("fuzzy_flc", 12)):
            law = experiments.law(name, inference)
            best = best_of(2, lambda arms=arms, law=law: batch_simulate(arms, law, scenario))
            line += f"{size * (scenario.n_steps + 1) / best / 1e6:{width}.2f}"
        print(line)


def best_of(repeats: int, work: Callable[[], object]) -> float:
    best = float("inf")
    for _ in range(repeats):
        begin = time.perf_counter()
        work()
        best = min(best, time.perf_counter() - begin)
    return best


if __name__ == "__main__":
    main()
