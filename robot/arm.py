"""The arm's parameters: frozen values in SI units, refused when no arm can have them."""

from __future__ import annotations

import functools
import math
import numbers
from collections.abc import Iterable, Sequence
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from robot.errors import InvalidArmError, UnknownNameError
from robot.kernels.dynamics import Parameters
from robot.presets import read_preset

MAX_MODULES = 8
"""Largest number of modules."""

ROD_RADIUS = 0.05
"""Radius (m) of the disc that stands for a rod when its inertia is not given."""

PRESETS = ("soft", "stiff")
"""Names for :meth:`Arm.preset`."""


class Arm(msgspec.Struct, frozen=True, kw_only=True):
    """A planar continuum arm of N modules in series, 1 to 8; equal by value and hashable.

    Arguments may be any sequences of numbers, arrays too; ``rod_length``, ``rest_length`` and ``inertia`` also one
    number for all modules. They are kept as tuples of floats.

    Attributes:
        mass: (N,) kg, each concentrated at the centre of its module's rod.
        rod_length: (N,) m, distance l between a module's two actuators.
        rest_length: (N,) m, length of the unloaded springs.
        stiffness: (2, N) N/m, row 0 for actuator 1 and row 1 for actuator 2 of every module.
        damping: (2, N) N s/m, likewise.
        inertia: (N,) kg m² of the rods; by default m (3 r² + L²) / 12 with r = 0.05 m and L the rest length.
        gravity: m/s² along n3; the arm hangs when it is positive.
        friction: N, Coulomb friction of the actuators, one number or (2, N); the F of equation (36).
        payload: kg, a mass that the last rod carries.
        payload_offset: m, how far the payload is before the last rod's centre, along the rod's normal; it then turns
            with θN.

    Raises:
        InvalidArmError: Wrong shapes, values that are not finite, mass, inertia or lengths that are not positive,
            negative stiffness, damping, friction or payload.
    """

    mass: Sequence[float]
    rod_length: float | Sequence[float]
    rest_length: float | Sequence[float]
    stiffness: Sequence[Sequence[float]]
    damping: Sequence[Sequence[float]]
    inertia: float | Sequence[float] | None = None
    gravity: float = 9.81
    friction: float | Sequence[Sequence[float]] = 0.0
    payload: float = 0.0
    payload_offset: float = 0.0

    def __post_init__(self) -> None:
        mass = _row(self.mass, "mass", None)
        n = len(mass)
        if not 1 <= n <= MAX_MODULES:
            raise InvalidArmError(f"found {n} modules; valid: 1 to {MAX_MODULES}", "mass")
        rest_length = _row(self.rest_length, "rest_length", n)
        inertia = self.inertia
        if inertia is None:
            inertia = [m * (3 * ROD_RADIUS**2 + length**2) / 12 for m, length in zip(mass, rest_length, strict=True)]
        values: dict[str, Any] = {
            "mass": mass,
            "rod_length": _row(self.rod_length, "rod_length", n),
            "rest_length": rest_length,
            "inertia": _row(inertia, "inertia", n),
            "stiffness": _pair(self.stiffness, "stiffness", n),
            "damping": _pair(self.damping, "damping", n),
            "gravity": _number(self.gravity, "gravity"),
            "friction": _pair(self.friction, "friction", n),
            "payload": _within(self.payload, 0.0, 100.0, "payload"),
            "payload_offset": _within(self.payload_offset, 0.0, 1.0, "payload_offset"),
        }
        for name in ("mass", "rod_length", "rest_length", "inertia"):
            for i, value in enumerate(values[name]):
                if value <= 0.0:
                    raise InvalidArmError(f"found {value:g}; valid: greater than 0", f"{name}[{i}]")
        for name in ("stiffness", "damping", "friction"):
            for row, pair in enumerate(values[name]):
                for i, value in enumerate(pair):
                    if value < 0.0:
                        raise InvalidArmError(f"found {value:g}; valid: 0 or more", f"{name}[{row}][{i}]")
        for name, value in values.items():
            msgspec.structs.force_setattr(self, name, value)

    @staticmethod
    def preset(name: str) -> Arm:
        """Return a shipped arm, ``soft`` or ``stiff``, of three modules.

        Raises:
            UnknownNameError: No such preset; the message lists the valid names.
        """
        if name not in PRESETS:
            raise UnknownNameError("arm", name, PRESETS)
        return msgspec.convert(read_preset(name), Arm)

    @property
    def n_modules(self) -> int:
        """Number of modules N."""
        return len(self.mass)

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the 2N coordinates in the order of q: ``s1 .. sN, theta1 .. thetaN``."""
        modules = range(1, self.n_modules + 1)
        return (*(f"s{i}" for i in modules), *(f"theta{i}" for i in modules))

    @property
    def actuators(self) -> tuple[str, ...]:
        """Names of the 2N actuator forces in the order of tau: ``F11, F21, F12, ...``, actuator before module."""
        return tuple(f"F{actuator}{module}" for module in range(1, self.n_modules + 1) for actuator in (1, 2))

    def scaled(self, *, mass: float = 1.0, stiffness: float = 1.0, damping: float = 1.0) -> Arm:
        """Return the arm with groups of parameters multiplied by factors; ``mass`` scales the rods' inertia too.

        The payload stays as it is.

        Raises:
            InvalidArmError: A factor that leaves no valid arm.
        """
        model = parameters(self)
        return msgspec.structs.replace(
            self,
            mass=model.mass * mass,
            inertia=model.inertia * mass,
            stiffness=model.stiffness * stiffness,
            damping=model.damping * damping,
        )


@functools.lru_cache(maxsize=4096)
def parameters(arm: Arm) -> Parameters:
    """Return the arm as the read-only arrays that kernels take."""
    return Parameters(
        mass=read_only(arm.mass),
        inertia=read_only(arm.inertia),
        half_rod=read_only(np.asarray(arm.rod_length) / 2),
        rest_length=read_only(arm.rest_length),
        stiffness=read_only(arm.stiffness),
        damping=read_only(arm.damping),
        gravity=arm.gravity,
        friction=read_only(arm.friction),
        has_friction=int(np.any(arm.friction)),
        payload=arm.payload,
        payload_offset=arm.payload_offset,
        stop_stiffness=0.0,
    )


def read_only(values: Any) -> NDArray[np.float64]:
    """Return a contiguous, read-only float64 copy, so that every kernel sees one and the same type."""
    array = np.array(values, dtype=np.float64, order="C")
    array.flags.writeable = False
    return array


def _number(value: object, path: str) -> float:
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        raise InvalidArmError(f"found {value!r}; valid: a number", path)
    number = float(value)
    if not math.isfinite(number):
        raise InvalidArmError(f"found {number}; valid: a finite number", path)
    return number


def _within(value: object, low: float, high: float, path: str) -> float:
    number = _number(value, path)
    if not low <= number <= high:
        raise InvalidArmError(f"found {number:g}; valid: {low:g} to {high:g}", path)
    return number


def _row(values: object, path: str, n: int | None) -> tuple[float, ...]:
    """Return ``n`` finite numbers; one number stands for all when ``n`` is known."""
    if n is not None and (isinstance(values, numbers.Real) or (isinstance(values, np.ndarray) and values.ndim == 0)):
        return (_number(float(values), path),) * n
    if isinstance(values, str | bytes) or not isinstance(values, Iterable):
        raise InvalidArmError(f"found {values!r}; valid: a sequence of numbers, one a module", path)
    row = tuple(_number(value, f"{path}[{i}]") for i, value in enumerate(values))
    if n is not None and len(row) != n:
        raise InvalidArmError(f"found {len(row)} values; valid: {n}, one a module as in mass", path)
    return row


def _pair(values: object, path: str, n: int) -> tuple[tuple[float, ...], tuple[float, ...]]:
    if path == "friction" and isinstance(values, numbers.Real):
        values = ((values,) * n,) * 2
    if isinstance(values, str | bytes) or not isinstance(values, Iterable):
        raise InvalidArmError(f"found {values!r}; valid: two rows of {n} numbers, one row an actuator", path)
    rows = list(values)
    if len(rows) != 2:
        raise InvalidArmError(f"found {len(rows)} rows; valid: 2, one an actuator", path)
    for i, row in enumerate(rows):
        if isinstance(row, numbers.Real):
            raise InvalidArmError(f"found {row!r}; valid: {n} numbers, one a module", f"{path}[{i}]")
    return _row(rows[0], f"{path}[0]", n), _row(rows[1], f"{path}[1]", n)
