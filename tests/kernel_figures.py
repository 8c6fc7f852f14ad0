"""Print what the kernels compute for a few dozen inputs and control steps, as JSON; see ``test_kernels.py``."""

from __future__ import annotations

import sys
from pathlib import Path

import msgspec
import numpy as np

from fuzzy.formats import load
from fuzzy.inference import Controller, compile_system
from fuzzy.system import Inference, Sampling
from robot import controllers
from robot.arm import Arm
from robot.scenario import Scenario
from robot.simulation import Simulation

RULEBASES = sorted((Path(__file__).parents[1] / "rulebases").glob("*.yaml"))

OPERATORS = (
    Inference(),
    Inference("product", "algebraic_sum", "product", "sum"),
    Inference(resolution=Sampling(50)),
    Inference("product", aggregation="sum", resolution=Sampling(51, "endpoints")),
    Inference(resolution=Sampling(52, "polygon")),
)


def outputs() -> list[list[float]]:
    """Return outputs of every shipped rule base under different operators, over and beyond the inputs' ranges."""
    figures: list[list[float]] = []
    for path in RULEBASES:
        system = load(path)
        axes = [np.linspace(1.1 * variable.low, 1.1 * variable.high, 7) for variable in system.inputs]
        grid = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, len(axes))
        for operators in OPERATORS:
            controller = compile_system(msgspec.structs.replace(system, inference=operators))
            figures.append(controller.batch(grid).ravel().tolist())
            figures.append(controller.explain(*grid[10]).strength.tolist())
            figures.append([float(np.sum(controller(*grid[11])))])
    return figures


def positions(controller: Controller) -> list[list[float]]:
    """Return where the arms are after some control steps under every control law."""
    figures: list[list[float]] = []
    for arm in (Arm.preset("soft"), Arm.preset("stiff")):
        for scenario in (Scenario.preset("step_noise"), Scenario.preset("sinus")):
            for name in controllers.NAMES:
                simulation = Simulation(arm, controllers.default(name, arm, scenario, controller), scenario)
                simulation.advance(25)
                figures.append([*simulation.q.tolist(), *simulation.dq.tolist()])
    return figures


def main() -> None:
    """Print all figures."""
    figures = [*outputs(), *positions(compile_system(load(RULEBASES[0])))]
    sys.stdout.write(msgspec.json.encode(figures).decode())


if __name__ == "__main__":
    main()
