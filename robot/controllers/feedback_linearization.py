"""Feedback linearization (computed torque) with a PD law on the linear error dynamics; equation (25)."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec

from robot.arm import Arm
from robot.controllers.base import Law, checked_gains, law

NATURAL_FREQUENCY = 12.0
"""Default natural frequency of the error where nothing disturbs the arm, rad/s."""

DISTURBED_NATURAL_FREQUENCY = 217.0
"""Default natural frequency under noise on the forces, rad/s; with it the standard step overshoots by about 2 %."""

DAMPING_RATIO = 1.0
"""Default damping ratio of the error."""


class PdFlc(msgspec.Struct, frozen=True):
    """Q = D̂ (q̈d + Kv ė + Kp e) + N̂, with the model's N̂ = Ĉ q̇ + B̂ q̇ + Ĝ.

    With a perfect model every coordinate obeys ë + Kv ė + Kp e = 0.

    Attributes:
        model: What the controller believes the arm to be.
        kp: (2N,) 1/s².
        kv: (2N,) 1/s.

    Raises:
        InvalidControllerError: Gains that are negative, not finite, or not one a coordinate.
    """

    model: Arm
    kp: Sequence[float]
    kv: Sequence[float]

    def __post_init__(self) -> None:
        size = 2 * self.model.n_modules
        msgspec.structs.force_setattr(self, "kp", checked_gains(self.kp, size, "kp"))
        msgspec.structs.force_setattr(self, "kv", checked_gains(self.kv, size, "kv"))

    @staticmethod
    def default(arm: Arm, natural_frequency: float = NATURAL_FREQUENCY, damping_ratio: float = DAMPING_RATIO) -> PdFlc:
        """Return the law with Kp = ωn² and Kv = 2 ζ ωn on every coordinate."""
        kp, kv = placed(natural_frequency, damping_ratio, 2 * arm.n_modules)
        return PdFlc(arm, kp, kv)

    def law(self) -> Law:
        """Return the gains as the kernel reads them."""
        return law(size=len(self.kp), linearizing=True, Kp=self.kp, Kd=self.kv)


def placed(natural_frequency: float, damping_ratio: float, size: int) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return Kp and Kv (2N,) that place the poles of every coordinate's error.

    Raises:
        InvalidControllerError: A frequency or ratio that is negative or not finite.
    """
    (frequency,) = set(checked_gains(natural_frequency, size, "natural_frequency"))
    (ratio,) = set(checked_gains(damping_ratio, size, "damping_ratio"))
    return (frequency**2,) * size, (2.0 * ratio * frequency,) * size
