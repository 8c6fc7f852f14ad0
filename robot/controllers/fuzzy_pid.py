"""PID with fuzzy blocks on the forces: a sum that estimates what the PID does not know, and a scaling of its gains."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec
import numpy as np

from robot.controllers.base import SCALING, Array, Law, keep_checked
from robot.controllers.fuzzy import ERROR_GAIN, OUTPUT_GAIN, Controller, check_blocks, output_scale
from robot.controllers.pid import Pid

RATE_SHARE = 0.1
"""Default GC: near the target the fuzzy block adds so much of Kd, so that a held force stays stable."""

SCALING_GAIN = 0.2
"""Default GU of the scaled PID: its gains grow by up to so much."""


class FuzzyPid(msgspec.Struct, frozen=True):
    """Q = Kp e + Kd ė + Ki ∫e dt + f̂ with f̂_i = GU_i · T(GE_i e_i, GC_i ė_i) / T_max, without a model; (46).

    Attributes:
        pid: The PID.
        inference: The compiled fuzzy system; two inputs (e, ė) and one output T.
        gu: (2N,) N and N m, f̂ at the end of T's range.
        ge: (2N,) the first input for an error of 1 m or 1 rad.
        gc: (2N,) the second input for an error's rate of 1 m/s or 1 rad/s.

    Raises:
        InvalidControllerError: Gains that are negative, not finite, or not one a coordinate; a fuzzy system with
            other than two inputs and one output.
    """

    pid: Pid
    inference: Controller
    gu: Sequence[float]
    ge: Sequence[float]
    gc: Sequence[float]

    def __post_init__(self) -> None:
        keep_checked(self, ("gu", "ge", "gc"), len(self.pid.kp))
        check_blocks(self.inference)

    @staticmethod
    def default(pid: Pid, inference: Controller, amplitude: Array) -> FuzzyPid:
        """Return GU = 0.3 Kp A and GE = 4/A, with a GC that adds a tenth of Kd, for motions of size A (2N,)."""
        gu = OUTPUT_GAIN * np.asarray(pid.kp) * amplitude
        ge, gc = input_gains(pid, inference, amplitude)
        return FuzzyPid(pid, inference, gu.tolist(), ge, gc)

    def law(self) -> Law:
        """Return the gains as the kernel reads them."""
        return with_blocks(self.pid.law(), self.inference, self.gu, self.ge, self.gc)


class ScaledPid(msgspec.Struct, frozen=True):
    """Q_i = (1 + GU_i |T(GE_i e_i, GC_i ė_i)| / T_max) (Kp e + Kd ė + Ki ∫e dt)_i.

    The only reading of (44) as a product that can regulate: a factor that changes its sign with the error would push
    the arm the same way on both sides of the target.

    Attributes:
        pid: The PID.
        inference: The compiled fuzzy system; two inputs (e, ė) and one output T.
        gu: (2N,) by how much the gains grow at the end of T's range; 1 doubles them.
        ge: (2N,) the first input for an error of 1 m or 1 rad.
        gc: (2N,) the second input for an error's rate of 1 m/s or 1 rad/s.

    Raises:
        InvalidControllerError: As for :class:`FuzzyPid`.
    """

    pid: Pid
    inference: Controller
    gu: Sequence[float]
    ge: Sequence[float]
    gc: Sequence[float]

    def __post_init__(self) -> None:
        keep_checked(self, ("gu", "ge", "gc"), len(self.pid.kp))
        check_blocks(self.inference)

    @staticmethod
    def default(pid: Pid, inference: Controller, amplitude: Array) -> ScaledPid:
        """Return GU = 0.2 and the inputs' gains of :meth:`FuzzyPid.default`, for motions of size A (2N,)."""
        ge, gc = input_gains(pid, inference, amplitude)
        return ScaledPid(pid, inference, (SCALING_GAIN,) * amplitude.size, ge, gc)

    def law(self) -> Law:
        """Return the gains as the kernel reads them."""
        return with_blocks(self.pid.law(), self.inference, self.gu, self.ge, self.gc)._replace(fuzzy=SCALING)


def input_gains(pid: Pid, inference: Controller, amplitude: Array) -> tuple[list[float], list[float]]:
    """Return GE and GC (2N,) of blocks beside a PID; at GU = 0.3 Kp A they add a tenth of Kd near the target."""
    rate = inference.system.inputs[1]
    gc = RATE_SHARE * rate.high * np.asarray(pid.kd) / (OUTPUT_GAIN * np.maximum(pid.kp, 1e-300) * amplitude)
    return (ERROR_GAIN / amplitude).tolist(), np.minimum(gc, 1e12).tolist()


def with_blocks(law: Law, inference: Controller, gu: Sequence[float], ge: Sequence[float], gc: Sequence[float]) -> Law:
    """Return a law on the forces with a fuzzy block on every coordinate that adds to it."""
    GU = np.zeros_like(law.GU)
    GU[1] = gu
    scale = np.ascontiguousarray(np.stack([ge, gc], axis=1))
    return law._replace(fuzzy=1, GU=GU, scale=scale, output_scale=output_scale(inference))
