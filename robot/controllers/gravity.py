"""PID with gravity, springs and friction compensated; equation (36)."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec
import numpy as np

from robot.arm import Arm
from robot.controllers.base import GRAVITY, Array, Law, keep_checked, law
from robot.controllers.pid import Pid

PROPORTIONAL_SHARE = 0.5
"""Default Kp in units of the plain PID's."""

INTEGRAL_SHARE = 0.1
"""Default Ki in units of the plain PID's: the model already holds the arm."""

BAND_SHARE = 0.1
"""Default band of the integral in units of the step."""


class PidGravity(msgspec.Struct, frozen=True):
    """Q = Kp e + Kd ė + Ki ∫e dt + Ĝ(q) + F̂(q̇), F̂ the Coulomb friction of the model.

    Without the integral, with an exact model and a constant target, V = ½ q̇ᵀ D q̇ + ½ eᵀ Kp e never grows; (37), (38).

    Attributes:
        model: What the controller believes the arm to be.
        kp: (2N,) N/m and N m/rad.
        kd: (2N,) N s/m and N m s/rad.
        ki: (2N,) N/(m s) and N m/(rad s).
        band: (2N,) m and rad, where the integral acts; infinity lets it act everywhere.

    Raises:
        InvalidControllerError: Gains that are negative, not finite, or not one a coordinate.
    """

    model: Arm
    kp: Sequence[float]
    kd: Sequence[float]
    ki: Sequence[float]
    band: Sequence[float]

    def __post_init__(self) -> None:
        keep_checked(self, ("kp", "kd", "ki", "band"), 2 * self.model.n_modules)

    @staticmethod
    def default(arm: Arm, amplitude: Array) -> PidGravity:
        """Return half of the plain PID's Kp, its Kd, and an integral that acts near the target only.

        Without the springs, which Ĝ takes away, all of Kp would overshoot on arms whose Kd has to be small.

        Args:
            arm: The controller's model.
            amplitude: (2N,) A, the positive size of every coordinate's motion, m and rad.
        """
        pid = Pid.default(arm)
        kp = PROPORTIONAL_SHARE * np.asarray(pid.kp)
        ki = INTEGRAL_SHARE * np.asarray(pid.ki)
        return PidGravity(arm, kp.tolist(), pid.kd, ki.tolist(), (BAND_SHARE * amplitude).tolist())

    def law(self) -> Law:
        """Return the gains as the kernel reads them."""
        gains = law(size=len(self.kp), linearizing=False, Kp=self.kp, Kd=self.kd, Ki=self.ki, band=self.band)
        return gains._replace(model=GRAVITY)
