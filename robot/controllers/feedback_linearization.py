"""Feedback linearization (computed torque) with a PD law on the linear error dynamics; equation (25)."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec

from robot.arm import Arm
from robot.controllers.base import Array, Law, checked_gains, keep_checked, law
from robot.controllers.pid import Pid
from robot.errors import InvalidControllerError

NATURAL_FREQUENCY = 12.0
"""Default natural frequency of the error where nothing disturbs the arm, rad/s."""

DISTURBED_NATURAL_FREQUENCY = 217.0
"""Default natural frequency under noise on the forces, rad/s; with it the standard step overshoots by about 2 %."""

DAMPING_RATIO = 1.0
"""Default damping ratio of the error."""


INTEGRAL_GAIN = 0.1
"""Default Ki in units of ωn³."""

BAND_SHARE = 0.1
"""Default band of the integral in units of the step."""


PARALLEL_INTEGRAL_SHARE = 0.1
"""Default Ki beside a feedback linearization in units of the plain PID's."""


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


class PidFlc(msgspec.Struct, frozen=True):
    """Q = D̂ (q̈d + Kv ė + Kp e + Ki ∫e dt) + N̂: the series of PID and feedback linearization; equation (3).

    The integral is conditional: it acts where the error is within ``band`` and no actuator is saturated.

    Attributes:
        model: What the controller believes the arm to be.
        kp: (2N,) 1/s².
        kv: (2N,) 1/s.
        ki: (2N,) 1/s³.
        band: (2N,) m and rad; infinity lets the integral act everywhere.

    Raises:
        InvalidControllerError: Gains that are negative, not finite, or not one a coordinate.
    """

    model: Arm
    kp: Sequence[float]
    kv: Sequence[float]
    ki: Sequence[float]
    band: Sequence[float]

    def __post_init__(self) -> None:
        keep_checked(self, ("kp", "kv", "ki", "band"), 2 * self.model.n_modules)

    @staticmethod
    def default(
        arm: Arm,
        amplitude: Array,
        natural_frequency: float = NATURAL_FREQUENCY,
        damping_ratio: float = DAMPING_RATIO,
    ) -> PidFlc:
        """Return Kp = ωn², Kv = 2 ζ ωn and Ki = 0.1 ωn³ within a tenth of the motion's size ``amplitude`` (2N,)."""
        kp, kv = placed(natural_frequency, damping_ratio, amplitude.size)
        ki = (INTEGRAL_GAIN * natural_frequency**3,) * amplitude.size
        return PidFlc(arm, kp, kv, ki, (BAND_SHARE * amplitude).tolist())

    def law(self) -> Law:
        """Return the gains as the kernel reads them."""
        return law(size=len(self.kp), linearizing=True, Kp=self.kp, Kd=self.kv, Ki=self.ki, band=self.band)


class Parallel(msgspec.Struct, frozen=True):
    """Q = [D̂ (q̈d + Kv ė + Kp e) + N̂] + [Kp' e + Kd' ė + Ki' ∫e dt]: equation (44) read as a sum.

    Attributes:
        flc: The feedback linearization.
        pid: The PID beside it.

    Raises:
        InvalidControllerError: Parts for different numbers of modules.
    """

    flc: PdFlc
    pid: Pid

    def __post_init__(self) -> None:
        if len(self.flc.kp) != len(self.pid.kp):
            found = f"found gains for {len(self.flc.kp)} and {len(self.pid.kp)} coordinates; valid: equal numbers"
            raise InvalidControllerError(found, "pid")

    @staticmethod
    def default(
        arm: Arm, natural_frequency: float = NATURAL_FREQUENCY, damping_ratio: float = DAMPING_RATIO
    ) -> Parallel:
        """Return the default laws side by side, with a tenth of the PID's Ki.

        The linearized arm has no springs that an integral would have to work against: with all of Ki the step would
        overshoot by a quarter.
        """
        pid = Pid.default(arm)
        slow = msgspec.structs.replace(pid, ki=[PARALLEL_INTEGRAL_SHARE * gain for gain in pid.ki])
        return Parallel(PdFlc.default(arm, natural_frequency, damping_ratio), slow)

    @property
    def model(self) -> Arm:
        """What the controller believes the arm to be."""
        return self.flc.model

    def law(self) -> Law:
        """Return the gains as the kernel reads them."""
        flc, pid = self.flc.law(), self.pid.law()
        return flc._replace(Kp=flc.Kp + pid.Kp, Kd=flc.Kd + pid.Kd, Ki=pid.Ki)


def placed(natural_frequency: float, damping_ratio: float, size: int) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return Kp and Kv (2N,) that place the poles of every coordinate's error.

    Raises:
        InvalidControllerError: A frequency or ratio that is negative or not finite.
    """
    (frequency,) = set(checked_gains(natural_frequency, size, "natural_frequency"))
    (ratio,) = set(checked_gains(damping_ratio, size, "damping_ratio"))
    return (frequency**2,) * size, (2.0 * ratio * frequency,) * size
