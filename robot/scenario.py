"""What is asked of the arm, and under which conditions: frozen values, some of them shipped."""

from __future__ import annotations

import math
import numbers
from collections.abc import Sequence as Values
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from robot import dynamics
from robot.arm import Arm, parameters
from robot.controllers.base import STEP
from robot.disturbance import BandLimitedNoise, Pulse, Push
from robot.dynamics import Reading
from robot.errors import InvalidScenarioError, UnknownNameError
from robot.presets import read_preset

Array = NDArray[np.float64]

MAX_DURATION = 600.0
"""Longest scenario, s."""

STANDARD_EXTENSION, STANDARD_BEND = 0.03, 0.3
"""Standard step: m on every s, rad on every θ."""

PRESETS = ("step", "step_noise", "sinus", "hold", "sequence", "circle")


class Step(msgspec.Struct, frozen=True, tag="step"):
    """At t = 0 the target jumps away from the start and stays.

    Attributes:
        extension: m on every s, one number or one a module.
        bend: rad on every θ, one number or one a module.
    """

    extension: float | Values[float] = STANDARD_EXTENSION
    bend: float | Values[float] = STANDARD_BEND

    def __post_init__(self) -> None:
        _normalise(self)


class Sinus(msgspec.Struct, frozen=True, tag="sinus"):
    """The target swings about the start: qd = q0 + A sin(2π f t). Its speed is not 0 at t = 0, the arm's is.

    Attributes:
        extension: A in m on every s, one number or one a module.
        bend: A in rad on every θ, one number or one a module.
        frequency: f in Hz, greater than 0, at most 20.
    """

    extension: float | Values[float] = STANDARD_EXTENSION
    bend: float | Values[float] = STANDARD_BEND
    frequency: float = 0.5

    def __post_init__(self) -> None:
        _normalise(self)
        if not 0.0 < _finite(self.frequency, "reference.frequency") <= 20.0:
            raise InvalidScenarioError(f"found {self.frequency:g}; valid: above 0, to 20", "reference.frequency")


class Hold(msgspec.Struct, frozen=True, tag="hold"):
    """The target stays at the start: what moves the arm is a disturbance."""


class Sequence(msgspec.Struct, frozen=True, tag="sequence"):
    """One step after another; the last one stays.

    Attributes:
        steps: Targets relative to the start, 1 to 1000.
        dwell: s from one step to the next, 0.001 to 600; rounded to whole control steps.
    """

    steps: tuple[Step, ...]
    dwell: float = 1.0

    def __post_init__(self) -> None:
        if not 1 <= len(self.steps) <= 1000:
            raise InvalidScenarioError(f"found {len(self.steps)} steps; valid: 1 to 1000", "reference.steps")
        if not STEP <= _finite(self.dwell, "reference.dwell") <= MAX_DURATION:
            found = f"found {self.dwell:g}; valid: {STEP:g} to {MAX_DURATION:g} s"
            raise InvalidScenarioError(found, "reference.dwell")


class TipCircle(msgspec.Struct, frozen=True, tag="circle"):
    """The centre of the last rod goes round a circle in the plane, which starts and ends in its resting place.

    The circle's centre is straight above that place. Of all positions with the tip on the circle the target is the
    one nearest to the start, lengths and angles measured in standard steps.

    Attributes:
        radius: m, above 0, at most 1.
        period: s for one round, 0.1 to 60.
    """

    radius: float = 0.03
    period: float = 3.0

    def __post_init__(self) -> None:
        if not 0.0 < _finite(self.radius, "reference.radius") <= 1.0:
            raise InvalidScenarioError(f"found {self.radius:g}; valid: above 0, to 1 m", "reference.radius")
        if not 0.1 <= _finite(self.period, "reference.period") <= 60.0:
            raise InvalidScenarioError(f"found {self.period:g}; valid: 0.1 to 60 s", "reference.period")


Reference = Step | Sinus | Hold | Sequence | TipCircle
"""All kinds of reference."""


class Payload(msgspec.Struct, frozen=True):
    """A mass that the last rod carries and the controller does not know.

    Attributes:
        mass: kg, 0 to 100.
        offset: m before the rod's centre along its normal, 0 to 1.
    """

    mass: float
    offset: float = 0.0

    def __post_init__(self) -> None:
        for name, most in (("mass", 100.0), ("offset", 1.0)):
            if not 0.0 <= _finite(getattr(self, name), f"payload.{name}") <= most:
                found = f"found {getattr(self, name):g}; valid: 0 to {most:g}"
                raise InvalidScenarioError(found, f"payload.{name}")


class Mismatch(msgspec.Struct, frozen=True):
    """How the plant differs from the arm the controller knows: factors on groups of parameters, 0.1 to 10.

    ``stiffness=1.3`` is a plant whose springs are 30 % stiffer than the controller believes. ``friction`` is a Coulomb
    friction of every actuator that the controller does not know, 0 to 100 N.
    """

    mass: float = 1.0
    stiffness: float = 1.0
    damping: float = 1.0
    friction: float = 0.0

    def __post_init__(self) -> None:
        if not 0.0 <= _finite(self.friction, "mismatch.friction") <= 100.0:
            raise InvalidScenarioError(f"found {self.friction:g}; valid: 0 to 100 N", "mismatch.friction")
        for name in ("mass", "stiffness", "damping"):
            if not 0.1 <= _finite(getattr(self, name), f"mismatch.{name}") <= 10.0:
                raise InvalidScenarioError(f"found {getattr(self, name):g}; valid: 0.1 to 10", f"mismatch.{name}")


class Scenario(msgspec.Struct, frozen=True, kw_only=True):
    """One experiment. The arm starts at rest in the plant's static equilibrium q0, without forces.

    Attributes:
        name: For people.
        reference: The target's motion, relative to q0.
        duration: s, above 0, at most 600; rounded to whole control steps.
        prefilter: None, or the natural frequency of a second-order filter between target and reference, 0.1 to 1000
            rad/s; its derivatives feed q̇d and q̈d.
        disturbance: None, or noise.
        pulses: Generalized forces on single coordinates for some time.
        pushes: Forces on points of the arm for some time.
        mismatch: How the plant differs from the controller's model.
        payload: None, or what the plant carries beyond the controller's model.
        force_limits: None, or the least and the greatest force of an actuator, N; (0, 60) is an arm that only pushes.
        valve_time: Time constant of first-order valves behind the limits, 0 to 10 s; 0 for none.
        stops: Whether smooth stops keep every actuator's length s ± (l/2) θ above 0, as far as forces allow.
        reading: Where an actuator's force reacts; see :data:`robot.dynamics.Reading`.

    Raises:
        InvalidScenarioError: Values that cannot be run.
    """

    name: str
    reference: Reference
    duration: float = 3.0
    prefilter: float | None = None
    disturbance: BandLimitedNoise | None = None
    pulses: tuple[Pulse, ...] = ()
    pushes: tuple[Push, ...] = ()
    mismatch: Mismatch = msgspec.field(default_factory=Mismatch)
    payload: Payload | None = None
    force_limits: tuple[float, float] | None = None
    valve_time: float = 0.0
    stops: bool = True
    reading: Reading = "internal"

    def __post_init__(self) -> None:
        if not STEP <= _finite(self.duration, "duration") <= MAX_DURATION:
            raise InvalidScenarioError(f"found {self.duration:g}; valid: {STEP:g} to {MAX_DURATION:g} s", "duration")
        if self.prefilter is not None and not 0.1 <= _finite(self.prefilter, "prefilter") <= 1000.0:
            raise InvalidScenarioError(f"found {self.prefilter:g}; valid: 0.1 to 1000 rad/s", "prefilter")
        if not 0.0 <= _finite(self.valve_time, "valve_time") <= 10.0:
            raise InvalidScenarioError(f"found {self.valve_time:g}; valid: 0 to 10 s", "valve_time")
        if self.force_limits is not None:
            limits = tuple(_finite(limit, "force_limits") for limit in self.force_limits)
            if len(limits) != 2 or not limits[0] <= 0.0 <= limits[1] or limits[0] == limits[1]:
                raise InvalidScenarioError(f"found {limits}; valid: least ≤ 0 ≤ greatest, not equal", "force_limits")
            msgspec.structs.force_setattr(self, "force_limits", limits)
        if self.reading not in dynamics.READINGS:
            valid = ", ".join(dynamics.READINGS)
            raise InvalidScenarioError(f"found {self.reading!r}; valid: {valid}", "reading")

    @staticmethod
    def preset(name: str) -> Scenario:
        """Return a shipped scenario.

        Raises:
            UnknownNameError: No such preset; the message lists the valid names.
        """
        if name not in PRESETS:
            raise UnknownNameError("scenario", name, PRESETS)
        return msgspec.convert(read_preset(name), Scenario)

    @property
    def n_steps(self) -> int:
        """Number of control steps."""
        return round(self.duration / STEP)

    def amplitude(self, n_modules: int) -> Array:
        """Return A (2N,) of every coordinate, m and rad, with its sign; 0 on a circle, which is no such motion.

        Of a sequence it is the largest step of every coordinate.

        Raises:
            InvalidScenarioError: A number of amplitudes other than N.
        """
        match self.reference:
            case Hold() | TipCircle():
                return np.zeros(2 * n_modules)
            case Sequence(steps=steps):
                targets = np.stack([amplitude(step, n_modules) for step in steps])
                return targets[np.abs(targets).argmax(axis=0), np.arange(2 * n_modules)]
            case _:
                return amplitude(self.reference, n_modules)

    def scale(self, n_modules: int) -> Array:
        """Return |A| (2N,), and the standard step's for coordinates that are not asked to move: never 0."""
        amplitude = np.abs(self.amplitude(n_modules))
        standard = np.repeat([STANDARD_EXTENSION, STANDARD_BEND], n_modules)
        return np.where(amplitude > 0.0, amplitude, standard)

    def plant(self, arm: Arm) -> Arm:
        """Return the arm that is simulated when the controller's model is ``arm``."""
        mismatch = self.mismatch
        plant = arm.scaled(mass=mismatch.mass, stiffness=mismatch.stiffness, damping=mismatch.damping)
        if mismatch.friction > 0.0:
            friction = [[value + mismatch.friction for value in row] for row in np.array(parameters(arm).friction)]
            plant = msgspec.structs.replace(plant, friction=friction)
        if self.payload is None:
            return plant
        return msgspec.structs.replace(plant, payload=self.payload.mass, payload_offset=self.payload.offset)


def amplitude(reference: Step | Sinus, n_modules: int) -> Array:
    """Return A (2N,) of a step or a sinus, m and rad, with its sign.

    Raises:
        InvalidScenarioError: A number of amplitudes other than N.
    """
    rows = []
    for name in ("extension", "bend"):
        values = np.atleast_1d(np.asarray(getattr(reference, name), dtype=np.float64))
        if values.size not in (1, n_modules):
            found = f"found {values.size} values; valid: 1, or {n_modules}, one a module"
            raise InvalidScenarioError(found, f"reference.{name}")
        rows.append(np.broadcast_to(values, n_modules))
    return np.concatenate(rows)


def names() -> tuple[str, ...]:
    """Return the names for :meth:`Scenario.preset`, in the order in which they are offered."""
    return PRESETS


def _finite(value: Any, path: str) -> float:
    if isinstance(value, bool) or not isinstance(value, numbers.Real) or not math.isfinite(value):
        raise InvalidScenarioError(f"found {value!r}; valid: a finite number", path)
    return float(value)


def _normalise(reference: Step | Sinus) -> None:
    """Check the amplitudes, and keep sequences as tuples."""
    for name, largest in (("extension", 1.0), ("bend", math.pi)):
        value = getattr(reference, name)
        values = (value,) if isinstance(value, numbers.Real) else tuple(value)
        for amplitude in values:
            if abs(_finite(amplitude, f"reference.{name}")) > largest:
                found = f"found {amplitude:g}; valid: -{largest:.4g} to {largest:.4g}"
                raise InvalidScenarioError(found, f"reference.{name}")
        normal = float(value) if isinstance(value, numbers.Real) else tuple(float(v) for v in values)
        msgspec.structs.force_setattr(reference, name, normal)
