"""Simulate many arms of which every parameter is off by up to 30 %, and print medians and 95th percentiles.

Run it from the project's folder: python examples/study_robustness.py [NUMBER OF ARMS]
"""

import sys

import fuzzy
from robot.experiments import robustness


def main(plants: str = "200") -> None:
    """Simulate and print a line for each law."""
    controller = fuzzy.compile_system(fuzzy.load("rulebases/diagonal.yaml"))
    print(f"{'overshoot, error in %':24}{'median':>10}{'95 %':>10}{'median':>10}{'95 %':>10}{'stopped %':>12}")
    for row in robustness(controller, int(plants), names=("pid", "pd_flc", "fuzzy_flc")):
        name, *figures = row
        print(f"{name:24}" + "".join(f"{value:10.2f}" for value in figures[:4]) + f"{figures[4]:12.1f}")


if __name__ == "__main__":
    main(*sys.argv[1:])
