"""A planar continuum arm: dynamics, controllers, disturbances and closed-loop simulation, in SI units.

What most users need stands here: :class:`Arm`, :class:`Scenario`, :func:`simulate`, :class:`Simulation`,
:func:`batch_simulate`, and the modules ``controllers``, ``dynamics`` and ``kinematics``. They are loaded when they
are first used.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from robot import controllers, dynamics, kinematics
    from robot.arm import Arm
    from robot.batch import batch_simulate
    from robot.run import Run
    from robot.scenario import Scenario
    from robot.simulation import Simulation, simulate

__all__ = [
    "Arm",
    "Run",
    "Scenario",
    "Simulation",
    "batch_simulate",
    "controllers",
    "dynamics",
    "kinematics",
    "simulate",
]

_HOME = {
    "Arm": "arm",
    "Scenario": "scenario",
    "Run": "run",
    "Simulation": "simulation",
    "simulate": "simulation",
    "batch_simulate": "batch",
}


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module 'robot' has no attribute '{name}'; valid: {', '.join(__all__)}")
    module = importlib.import_module(f"robot.{_HOME.get(name, name)}")
    return getattr(module, name) if name in _HOME else module
