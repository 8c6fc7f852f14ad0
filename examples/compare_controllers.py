"""Compare all control laws on one scenario, on an arm whose springs are stiffer than they believe.

Run it from the project's folder: python examples/compare_controllers.py
"""

from msgspec.structs import replace

import fuzzy
import robot
from robot.scenario import Mismatch


def main() -> None:
    """Print a line for every control law."""
    controller = fuzzy.compile_system(fuzzy.load("rulebases/diagonal.yaml"))
    arm = robot.Arm.preset("soft")
    scenario = replace(robot.Scenario.preset("step"), mismatch=Mismatch(stiffness=1.1))
    print(f"{'':20}{'overshoot %':>14}{'error %':>10}{'peak force N':>14}")
    for name in robot.controllers.NAMES:
        law = robot.controllers.default(name, arm, scenario, controller)
        metrics = robot.simulate(arm, law, scenario).metrics()
        figures = metrics.overshoot["worst"], metrics.steady_state_error["worst"], metrics.peak_force["worst"]
        print(f"{name:20}{figures[0]:14.2f}{figures[1]:10.2f}{figures[2]:14.0f}")


if __name__ == "__main__":
    main()
