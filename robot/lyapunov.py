"""Lyapunov functions of the control laws, as signals of a run."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from robot import dynamics
from robot.arm import Arm
from robot.controllers import AdaptiveFuzzyFlc, ControlLaw, FuzzyFlc, PdFlc, Pid, PidFlc, PidGravity
from robot.errors import InvalidControllerError

Array = NDArray[np.float64]


class Motion(Protocol):
    """What a Lyapunov function is evaluated on, one row a control step."""

    @property
    def q(self) -> Array:
        """(n, 2N) position."""
        ...

    @property
    def dq(self) -> Array:
        """(n, 2N) velocity."""
        ...

    @property
    def learned(self) -> Array:
        """(n, 2N) |θ|² of the adapted blocks."""
        ...


def values(plant: Arm, controller: ControlLaw, reference: Array, dreference: Array, motion: Motion) -> Array:
    """Return V (n,) of a control law along a motion.

    - ``pid`` and ``pid_gravity``: V = ½ q̇ᵀ D q̇ + ½ eᵀ Kp e, J (37). It never grows for PD with an exact Ĝ and a
      constant target; with an integral, whose state V does not hold, it may.
    - ``pd_flc``, ``pid_flc``, ``fuzzy_flc``: V = eᵀ P e of the linear error dynamics, which never grows for ``pd_flc``
      with an exact model.
    - ``adaptive_fuzzy_flc``: V = eᵀ P e + θᵀ θ/γ, which never grows with an exact model (then θ* = 0) and σ = 0.

    P of every coordinate solves AᵀP + PA = -diag(1, 1/Kp): p11 = Kv/(2 Kp) + 1/Kv, p12 = 1/(2 Kp), p22 = 1/(Kp Kv).

    Args:
        plant: The arm that moved.
        controller: The law.
        reference: (n, 2N) qd.
        dreference: (n, 2N) its rate.
        motion: Positions, velocities and what was learned.

    Raises:
        InvalidControllerError: A law for which no Lyapunov function is known.
    """
    e = reference - motion.q
    de = dreference - motion.dq
    match controller:
        case Pid() | PidGravity():
            rows = zip(motion.q, motion.dq, strict=True)
            kinetic = np.array([dynamics.energy(plant, q, dq).kinetic for q, dq in rows])
            return kinetic + 0.5 * e**2 @ np.asarray(controller.kp)
        case AdaptiveFuzzyFlc():
            gamma = np.asarray(controller.gamma)
            share = np.divide(1.0, gamma, out=np.zeros_like(gamma), where=gamma > 0.0)
            return _quadratic(controller.kp, controller.kv, e, de) + motion.learned @ share
        case PdFlc() | PidFlc() | FuzzyFlc():
            return _quadratic(controller.kp, controller.kv, e, de)
        case _:
            name = type(controller).__name__
            raise InvalidControllerError(f"found {name}; valid: a PID, or feedback linearization alone", "controller")


def _quadratic(kp: object, kv: object, e: Array, de: Array) -> Array:
    p, v = np.asarray(kp, dtype=np.float64), np.asarray(kv, dtype=np.float64)
    return e**2 @ (v / (2 * p) + 1 / v) + (e * de) @ (1 / p) + de**2 @ (1 / (p * v))
