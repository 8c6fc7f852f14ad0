"""PID on every coordinate, without a model of the arm; equation (19)."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec
import numpy as np

from robot import dynamics
from robot.arm import Arm
from robot.controllers.base import STEP, Law, checked_gains, law

PROPORTIONAL, DERIVATIVE, INTEGRAL = 2.0, 0.30, 8.65
"""Default gains in units of the stiffness of each coordinate: 1, s and 1/s."""

HIGHEST_RATE = 1.6
"""Largest eigenvalue of D⁻¹ Kd times the control step; a held force is stable below 2."""


class Pid(msgspec.Struct, frozen=True):
    """Q = Kp e + Kd ė + Ki ∫e dt, one entry a coordinate (s before theta).

    The integral stands still while an actuator of the module is saturated and integrating would push further.

    Attributes:
        kp: (2N,) N/m and N m/rad.
        kd: (2N,) N s/m and N m s/rad.
        ki: (2N,) N/(m s) and N m/(rad s).

    Raises:
        InvalidControllerError: Gains that are negative, not finite, or not one a coordinate.
    """

    kp: Sequence[float]
    kd: Sequence[float]
    ki: Sequence[float]

    def __post_init__(self) -> None:
        kp = checked_gains(self.kp, None, "kp")
        msgspec.structs.force_setattr(self, "kp", kp)
        msgspec.structs.force_setattr(self, "kd", checked_gains(self.kd, len(kp), "kd"))
        msgspec.structs.force_setattr(self, "ki", checked_gains(self.ki, len(kp), "ki"))

    @staticmethod
    def default(arm: Arm) -> Pid:
        """Return gains in proportion to the stiffness K = ∂G/∂q of each coordinate at the equilibrium.

        On the soft arm Kp = 2 K, Kd = 0.30 s K and Ki = 8.65 K/s, which gives the standard step an overshoot of
        2.8 %. Where a force held for a control step would let Kd overturn the lightest motion of a stiffer arm, Kp
        and Kd are smaller, and so is Ki such that the integral acts with the same rate Ki / (K + Kp).
        """
        q = dynamics.equilibrium(arm)
        stiffness = np.diag(dynamics.stiffness_matrix(arm, q))
        D = dynamics.mass_matrix(arm, q)
        rate = float(np.abs(np.linalg.eigvals(np.linalg.solve(D, np.diag(DERIVATIVE * stiffness)))).max())
        share = min(1.0, HIGHEST_RATE / (rate * STEP))
        rest = (1.0 + share * PROPORTIONAL) / (1.0 + PROPORTIONAL)
        return Pid(
            kp=(share * PROPORTIONAL * stiffness).tolist(),
            kd=(share * DERIVATIVE * stiffness).tolist(),
            ki=(rest * INTEGRAL * stiffness).tolist(),
        )

    def law(self) -> Law:
        """Return the gains as the kernel reads them."""
        return law(size=len(self.kp), linearizing=False, Kp=self.kp, Kd=self.kd, Ki=self.ki)
