"""Feedback linearization with a parallel Mamdani block on every coordinate: the proposed controller; (44)-(46)."""

from __future__ import annotations

import math
from collections.abc import Sequence

import msgspec
import numpy as np

from fuzzy.inference import Controller
from fuzzy.kernels.address import Directory, workspace_at
from fuzzy.kernels.inference import evaluate
from robot.arm import Arm
from robot.controllers.base import Array, Law, checked_gains, law
from robot.controllers.feedback_linearization import DAMPING_RATIO, NATURAL_FREQUENCY, placed
from robot.errors import InvalidControllerError
from robot.kernels.jit import counting_kernel

ERROR_GAIN = 4.0
"""Default GE times the step: an error of a quarter of the step reaches the end of the range [-1, 1]."""

RATE_GAIN = 48.0
"""Default GC times step and natural frequency; the range of ė is [-6, 6]."""

OUTPUT_GAIN = 0.3
"""Default GU in units of ωn² times the step: the most the fuzzy block adds to the linear law's first reaction."""


class FuzzyFlc(msgspec.Struct, frozen=True):
    """Q = D̂ (q̈d + Kp e + Kv ė + Ki ∫e dt + f̂) + N̂ with f̂_i = GU_i · T(GE_i e_i, GC_i ė_i) / T_max.

    One block of the same fuzzy system acts on every coordinate. The integral is conditional: it acts where the error
    is within ``band`` and stands still while an actuator of the module is saturated and integrating would push
    further. An integral that is not conditional cannot give a step without overshoot.

    Attributes:
        model: What the controller believes the arm to be.
        inference: The compiled fuzzy system; two inputs (e, ė) and one output T.
        kp: (2N,) 1/s².
        kv: (2N,) 1/s.
        ki: (2N,) 1/s³.
        gu: (2N,) m/s² and rad/s², f̂ at the end of T's range.
        ge: (2N,) the first input for an error of 1 m or 1 rad.
        gc: (2N,) the second input for an error's rate of 1 m/s or 1 rad/s.
        band: (2N,) m and rad; infinity lets the integral act everywhere.

    Raises:
        InvalidControllerError: Gains that are negative, not finite, or not one a coordinate; a fuzzy system with
            other than two inputs and one output.
    """

    model: Arm
    inference: Controller
    kp: Sequence[float]
    kv: Sequence[float]
    ki: Sequence[float]
    gu: Sequence[float]
    ge: Sequence[float]
    gc: Sequence[float]
    band: Sequence[float]

    def __post_init__(self) -> None:
        size = 2 * self.model.n_modules
        for name in ("kp", "kv", "ki", "gu", "ge", "gc", "band"):
            gains = checked_gains(getattr(self, name), size, name, infinite=name == "band")
            msgspec.structs.force_setattr(self, name, gains)
        system = self.inference.system
        if len(system.inputs) != 2 or len(system.outputs) != 1:
            raise InvalidControllerError(
                f"found a fuzzy system with {len(system.inputs)} inputs and {len(system.outputs)} outputs; "
                "valid: two inputs (e and its rate) and one output",
                "inference",
            )

    @staticmethod
    def default(
        arm: Arm,
        inference: Controller,
        amplitude: Array,
        natural_frequency: float = NATURAL_FREQUENCY,
        damping_ratio: float = DAMPING_RATIO,
    ) -> FuzzyFlc:
        """Return GU = 0.3 ωn² A, GE = 4/A and GC = 48/(A ωn), without an integral.

        Args:
            arm: The controller's model.
            inference: The compiled fuzzy system.
            amplitude: (2N,) A, the positive size of every coordinate's motion, m and rad.
            natural_frequency: ωn, rad/s; greater than 0.
            damping_ratio: ζ.
        """
        kp, kv = placed(natural_frequency, damping_ratio, amplitude.size)
        if natural_frequency == 0.0:
            raise InvalidControllerError("found 0; valid: greater than 0", "natural_frequency")
        return FuzzyFlc(
            model=arm,
            inference=inference,
            kp=kp,
            kv=kv,
            ki=(0.0,) * amplitude.size,
            gu=(OUTPUT_GAIN * natural_frequency**2 * amplitude).tolist(),
            ge=(ERROR_GAIN / amplitude).tolist(),
            gc=(RATE_GAIN / (amplitude * natural_frequency)).tolist(),
            band=(math.inf,) * amplitude.size,
        )

    def law(self) -> Law:
        """Return the gains as the kernel reads them."""
        output = self.inference.system.outputs[0]
        return law(
            size=len(self.kp),
            linearizing=True,
            Kp=self.kp,
            Kd=self.kv,
            Ki=self.ki,
            GU=self.gu,
            scale=np.stack([self.ge, self.gc], axis=1).tolist(),
            output_scale=1.0 / max(abs(output.low), abs(output.high)),
            band=self.band,
        )

    def directory(self) -> Directory:
        """Return the compiled system with a workspace of its own; the simulation must keep it alive."""
        return self.inference.directory()


@counting_kernel
def fuzzy_blocks(
    address: int, scale: Array, e: Array, de: Array, x: Array, block: Array, output: Array, activity: Array
) -> None:
    """Evaluate the fuzzy block of every coordinate.

    Args:
        address: Of the compiled system and its workspace.
        scale: (2N, 2) GE and GC.
        e: (2N,) error.
        de: (2N,) its rate.
        x: (2N, 2) out, the blocks' inputs.
        block: (1,) out, the last block's output.
        output: (2N,) in: last outputs, for the hold policy; out: T, NaN where the error is not finite.
        activity: (2N, n_rules) in and out, the largest firing strength so far.
    """
    workspace = workspace_at(address)
    for i in range(output.size):
        x[i, 0] = scale[i, 0] * e[i]
        x[i, 1] = scale[i, 1] * de[i]
        block[0] = output[i]
        fired = evaluate(address, x[i], block)
        output[i] = block[0]
        for k in range(fired):
            rule = workspace.fired[k]
            activity[i, rule] = max(activity[i, rule], workspace.strength[rule])
