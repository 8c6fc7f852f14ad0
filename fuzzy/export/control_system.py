"""A controller for python-control: a system without states, to be connected into an existing loop."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fuzzy.errors import FuzzyError
from fuzzy.inference import compile_system
from fuzzy.system import FuzzySystem

if TYPE_CHECKING:
    from control import NonlinearIOSystem


def to_control_system(system: FuzzySystem, name: str | None = None) -> NonlinearIOSystem:
    """Return a controller as a NonlinearIOSystem of python-control.

    Its inputs and outputs have the names of the system's. It has no state: an output that holds its last value when
    no rule fires has the middle of its range then, since a solver does not go through time in order.

    Args:
        system: A valid system.
        name: Name of the system in a diagram; by default the document's.

    Raises:
        FuzzyError: python-control is not installed.
        InvalidInputError: From the solver, for an input that is not finite or that is refused.
    """
    try:
        import control
    except ImportError:
        raise FuzzyError("python-control is not installed: pip install 'fuzzy-arm-workbench[control]'") from None
    controller = compile_system(system)

    def output(_time: Any, _state: Any, inputs: Any, _parameters: Any) -> Any:
        return controller.batch(np.reshape(np.asarray(inputs, dtype=np.float64), (1, -1)))[0]

    return control.NonlinearIOSystem(
        None,
        output,
        inputs=[entry.name for entry in system.inputs],
        outputs=[entry.name for entry in system.outputs],
        name=name or system.name,
    )
