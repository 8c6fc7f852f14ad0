"""How fast the closed loop runs: µs a control step (1 ms), and times real time, on one core.

Run as ``python benchmarks/closed_loop.py`` from the repository's root, on an idle machine.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

import fuzzy
from robot import controllers
from robot.arm import Arm
from robot.scenario import Scenario
from robot.simulation import simulate

ROOT = Path(__file__).parents[1]


def main(repeats: int = 20) -> None:
    """Print one line a control law and arm; the best of ``repeats`` whole runs, set-up and logging included."""
    inference = fuzzy.compile_system(fuzzy.load(ROOT / "rulebases" / "diagonal.yaml"))
    scenario = Scenario.preset("step")
    print(f"{'arm':8}{'controller':14}{'µs/step':>10}{'× real time':>14}   (first call: s)")
    for arm_name in ("soft", "stiff"):
        arm = Arm.preset(arm_name)
        for name in controllers.NAMES:
            law = controllers.default(name, arm, scenario, inference)
            begin = time.perf_counter()
            simulate(arm, law, scenario)
            first = time.perf_counter() - begin
            best = float("inf")
            for _ in range(repeats):
                begin = time.perf_counter()
                simulate(arm, law, scenario)
                best = min(best, time.perf_counter() - begin)
            steps = scenario.n_steps + 1
            speed = scenario.duration / best
            print(f"{arm_name:8}{name:14}{best / steps * 1e6:10.2f}{speed:14.0f}   ({first:.3g})")


if __name__ == "__main__":
    main()
