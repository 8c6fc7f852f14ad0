"""Control laws: frozen values, selectable by name."""

from __future__ import annotations

from robot.arm import Arm
from robot.controllers.base import Law, checked_gains
from robot.controllers.feedback_linearization import (
    DAMPING_RATIO,
    DISTURBED_NATURAL_FREQUENCY,
    NATURAL_FREQUENCY,
    PdFlc,
)
from robot.controllers.fuzzy import Controller as FuzzyController
from robot.controllers.fuzzy import FuzzyFlc
from robot.controllers.pid import Pid
from robot.errors import InvalidControllerError, UnknownNameError
from robot.scenario import Scenario

__all__ = [
    "NAMES",
    "ControlLaw",
    "FuzzyFlc",
    "Law",
    "PdFlc",
    "Pid",
    "checked_gains",
    "default",
    "default_natural_frequency",
]

ControlLaw = Pid | PdFlc | FuzzyFlc
"""All control laws."""

NAMES = ("pid", "pd_flc", "fuzzy_flc")
"""Names for :func:`default`, in the order in which they are offered."""


def default_natural_frequency(scenario: Scenario) -> float:
    """Return ωn, rad/s: slow enough to watch where nothing disturbs, fast enough to hold against noise.

    Feedback linearization takes away the springs that hold the arm under PID: what is left against a force is D ωn².
    Against noise on the forces it therefore needs a bandwidth far over that of the motion, or it does worse than PID.
    """
    return NATURAL_FREQUENCY if scenario.disturbance is None else DISTURBED_NATURAL_FREQUENCY


def default(
    name: str,
    arm: Arm,
    scenario: Scenario,
    fuzzy_controller: FuzzyController | None = None,
    *,
    natural_frequency: float | None = None,
    damping_ratio: float = DAMPING_RATIO,
) -> ControlLaw:
    """Return a control law with the gains that suit an arm and a scenario; ``msgspec.structs.replace`` changes them.

    Args:
        name: One of ``NAMES``.
        arm: The controller's model; the plant may differ by the scenario's mismatch.
        scenario: Its amplitudes scale the fuzzy blocks.
        fuzzy_controller: The compiled fuzzy system, for the laws that have one.
        natural_frequency: ωn of the feedback linearization, rad/s; by default what the scenario asks for, see
            :func:`default_natural_frequency`.
        damping_ratio: ζ of the feedback linearization.

    Raises:
        UnknownNameError: No such law; the message lists the valid names.
        InvalidControllerError: No fuzzy system, or one that does not fit.
    """
    if natural_frequency is None:
        natural_frequency = default_natural_frequency(scenario)
    match name:
        case "pid":
            return Pid.default(arm)
        case "pd_flc":
            return PdFlc.default(arm, natural_frequency, damping_ratio)
        case "fuzzy_flc":
            if fuzzy_controller is None:
                raise InvalidControllerError("found no fuzzy system; valid: a compiled one", "fuzzy_controller")
            scale = scenario.scale(arm.n_modules)
            return FuzzyFlc.default(arm, fuzzy_controller, scale, natural_frequency, damping_ratio)
        case _:
            raise UnknownNameError("controller", name, NAMES)
