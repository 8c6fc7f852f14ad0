"""Simulate the arm's step under the edited rules, print figures of merit, and save the run.

Run it from the project's folder: python examples/simulate_a_step.py [RULEBASE]
"""

import sys

import numpy as np

import fuzzy
import robot


def main(path: str = "rulebases/diagonal.yaml") -> None:
    """Simulate and print."""
    controller = fuzzy.compile_system(fuzzy.load(path))
    arm, scenario = robot.Arm.preset("soft"), robot.Scenario.preset("step")
    law = robot.controllers.default("fuzzy_flc", arm, scenario, controller)
    run = robot.simulate(arm, law, scenario)
    metrics = run.metrics()
    print(f"overshoot {metrics.overshoot['worst']:.2f} %, settled after {metrics.settling_time['worst']:.3f} s")
    print(f"largest force {np.abs(run.forces).max():.0f} N over {run.t.size} samples")


if __name__ == "__main__":
    main(*sys.argv[1:])
