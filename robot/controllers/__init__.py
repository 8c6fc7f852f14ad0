"""Control laws: frozen values, selectable by name."""

from __future__ import annotations

from typing import TYPE_CHECKING

from robot.arm import Arm
from robot.controllers.adaptive import AdaptiveFuzzyFlc, AdaptiveFuzzyPid
from robot.controllers.base import Array, Law, checked_gains
from robot.controllers.feedback_linearization import (
    DAMPING_RATIO,
    DISTURBED_NATURAL_FREQUENCY,
    NATURAL_FREQUENCY,
    Parallel,
    PdFlc,
    PidFlc,
)
from robot.controllers.fuzzy import Controller as FuzzyController
from robot.controllers.fuzzy import FuzzyFlc
from robot.controllers.fuzzy_pid import FuzzyPid, ScaledPid
from robot.controllers.gravity import PidGravity
from robot.controllers.pid import Pid
from robot.controllers.tuning import GAINS, Gain, gains, scaled
from robot.errors import InvalidControllerError, UnknownNameError

if TYPE_CHECKING:
    from robot.scenario import Scenario

__all__ = [
    "GAINS",
    "NAMES",
    "AdaptiveFuzzyFlc",
    "AdaptiveFuzzyPid",
    "ControlLaw",
    "FuzzyFlc",
    "FuzzyPid",
    "Gain",
    "Law",
    "Parallel",
    "PdFlc",
    "Pid",
    "PidFlc",
    "PidGravity",
    "ScaledPid",
    "checked_gains",
    "default",
    "default_natural_frequency",
    "gains",
    "has_natural_frequency",
    "inference_of",
    "model_of",
    "needs_rules",
    "scaled",
]

ControlLaw = (
    Pid | PidGravity | PdFlc | PidFlc | Parallel | FuzzyFlc | FuzzyPid | AdaptiveFuzzyPid | AdaptiveFuzzyFlc | ScaledPid
)
"""All control laws."""

NAMES = (
    "pid",
    "pd_flc",
    "fuzzy_flc",
    "pid_gravity",
    "pid_flc",
    "parallel",
    "fuzzy_pid",
    "adaptive_fuzzy_pid",
    "adaptive_fuzzy_flc",
    "scaled_pid",
)
"""Names for :func:`default`, in the order in which they are offered."""


def has_natural_frequency(name: str) -> bool:
    """Return whether the law of this name places the error's poles by a natural frequency."""
    return name.endswith("flc") or name == "parallel"


def needs_rules(name: str) -> bool:
    """Return whether the law of this name has fuzzy blocks."""
    return "fuzzy" in name or name == "scaled_pid"


def model_of(controller: ControlLaw) -> Arm | None:
    """Return what the law believes the arm to be; None for a law without a model."""
    match controller:
        case PidGravity() | PdFlc() | PidFlc() | Parallel() | FuzzyFlc() | AdaptiveFuzzyFlc():
            return controller.model
        case _:
            return None


def inference_of(controller: ControlLaw) -> FuzzyController | None:
    """Return the compiled fuzzy system of the law's blocks; None for a law without."""
    match controller:
        case FuzzyFlc() | FuzzyPid() | AdaptiveFuzzyPid() | AdaptiveFuzzyFlc() | ScaledPid():
            return controller.inference
        case _:
            return None


def default_natural_frequency(scenario: Scenario) -> float:
    """Return ωn, rad/s: slow enough to watch where nothing disturbs, fast enough to hold against noise.

    Feedback linearization takes away the springs that hold the arm under PID: what is left against a force is D ωn².
    Against noise on the forces, pulses and pushes it therefore needs a bandwidth far over that of the motion, or it
    does worse than PID.
    """
    disturbance = scenario.disturbance
    noisy = disturbance is not None and disturbance.channel == "force"
    disturbed = noisy or bool(scenario.pulses) or bool(scenario.pushes)
    return DISTURBED_NATURAL_FREQUENCY if disturbed else NATURAL_FREQUENCY


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
    if name not in NAMES:
        raise UnknownNameError("controller", name, NAMES)
    if natural_frequency is None:
        natural_frequency = default_natural_frequency(scenario)
    scale = scenario.scale(arm.n_modules)
    if needs_rules(name):
        if fuzzy_controller is None:
            raise InvalidControllerError("found no fuzzy system; valid: a compiled one", "fuzzy_controller")
        return _with_blocks(name, arm, fuzzy_controller, scale, natural_frequency, damping_ratio)
    match name:
        case "pid":
            return Pid.default(arm)
        case "pid_gravity":
            return PidGravity.default(arm, scale)
        case "pd_flc":
            return PdFlc.default(arm, natural_frequency, damping_ratio)
        case "pid_flc":
            return PidFlc.default(arm, scale, natural_frequency, damping_ratio)
        case _:
            return Parallel.default(arm, natural_frequency, damping_ratio)


def _with_blocks(
    name: str, arm: Arm, inference: FuzzyController, scale: Array, natural_frequency: float, damping_ratio: float
) -> ControlLaw:
    match name:
        case "fuzzy_flc":
            return FuzzyFlc.default(arm, inference, scale, natural_frequency, damping_ratio)
        case "adaptive_fuzzy_flc":
            return AdaptiveFuzzyFlc.default(arm, inference, scale, natural_frequency, damping_ratio)
        case "fuzzy_pid":
            return FuzzyPid.default(Pid.default(arm), inference, scale)
        case "adaptive_fuzzy_pid":
            return AdaptiveFuzzyPid.default(Pid.default(arm), inference, scale)
        case _:
            return ScaledPid.default(Pid.default(arm), inference, scale)
