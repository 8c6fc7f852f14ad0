"""Feedback linearization with a parallel Mamdani block on every coordinate: the proposed controller; (44)-(46)."""

from __future__ import annotations

import math
from collections.abc import Sequence

import msgspec
import numpy as np
from numpy.typing import NDArray

from fuzzy.inference import Controller
from fuzzy.kernels import firing, membership
from fuzzy.kernels.address import Directory as Directory
from fuzzy.kernels.address import inputs_at, workspace_at
from fuzzy.kernels.inference import evaluate
from fuzzy.kernels.jit import borrowing_kernel, inlined_kernel
from robot.arm import Arm
from robot.controllers.base import ADAPTED_GAUSSIANS, Array, Law, keep_checked, law
from robot.controllers.feedback_linearization import DAMPING_RATIO, NATURAL_FREQUENCY, placed
from robot.errors import InvalidControllerError

ERROR_GAIN = 4.0
"""Default GE times the step: an error of a quarter of the step reaches the end of the range [-1, 1]."""

RATE_GAIN = 48.0
"""Default GC times step and natural frequency; the range of ė is [-6, 6]."""

CLAMPED, UNDEFINED = 0, 1
"""Columns of the counts of control steps: an input outside its range, and an output that the no-fire policy gave."""

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
        keep_checked(self, ("kp", "kv", "ki", "gu", "ge", "gc", "band"), size)
        check_blocks(self.inference)

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
        ge, gc = input_scales(amplitude, natural_frequency)
        return FuzzyFlc(
            model=arm,
            inference=inference,
            kp=kp,
            kv=kv,
            ki=(0.0,) * amplitude.size,
            gu=(OUTPUT_GAIN * natural_frequency**2 * amplitude).tolist(),
            ge=ge,
            gc=gc,
            band=(math.inf,) * amplitude.size,
        )

    def law(self) -> Law:
        """Return the gains as the kernel reads them."""
        return law(
            size=len(self.kp),
            linearizing=True,
            Kp=self.kp,
            Kd=self.kv,
            Ki=self.ki,
            GU=self.gu,
            scale=np.stack([self.ge, self.gc], axis=1).tolist(),
            output_scale=output_scale(self.inference),
            band=self.band,
        )


def input_scales(amplitude: Array, natural_frequency: float) -> tuple[list[float], list[float]]:
    """Return GE = 4/A and GC = 48/(A ωn), which spread a step of size A and its rates over the ranges of a block.

    Args:
        amplitude: (2N,) A, the positive size of every coordinate's motion, m and rad.
        natural_frequency: ωn, rad/s.

    Raises:
        InvalidControllerError: A natural frequency of 0.
    """
    if natural_frequency == 0.0:
        raise InvalidControllerError("found 0; valid: greater than 0", "natural_frequency")
    return (ERROR_GAIN / amplitude).tolist(), (RATE_GAIN / (amplitude * natural_frequency)).tolist()


def check_blocks(inference: Controller) -> None:
    """Refuse a fuzzy system that is no block of a coordinate.

    Raises:
        InvalidControllerError: Other than two inputs and one output.
    """
    system = inference.system
    if len(system.inputs) != 2 or len(system.outputs) != 1:
        raise InvalidControllerError(
            f"found a fuzzy system with {len(system.inputs)} inputs and {len(system.outputs)} outputs; "
            "valid: two inputs (e and its rate) and one output",
            "inference",
        )


def output_scale(inference: Controller) -> float:
    """Return 1 / T_max of a fuzzy block."""
    output = inference.system.outputs[0]
    return 1.0 / max(abs(output.low), abs(output.high))


@borrowing_kernel
def fuzzy_blocks(
    address: int,
    scale: Array,
    e: Array,
    de: Array,
    x: Array,
    block: Array,
    output: Array,
    activity: Array,
    counts: NDArray[np.int64],
) -> int:
    """Evaluate the fuzzy block of every coordinate.

    Args:
        address: Of the compiled system and its workspace.
        scale: (2N, 2) GE and GC.
        e: (2N,) error.
        de: (2N,) its rate.
        x: (2N, 2) out, the blocks' inputs.
        block: (1,) out, the last block's output.
        output: (2N,) in: last outputs, for the hold policy; out: T, NaN where an input is not finite or is rejected.
        activity: (2N, n_rules) in and out, the largest firing strength so far.
        counts: (2N, 2) in and out, how often an input was clamped, and how often the no-fire policy gave T.

    Returns:
        A coordinate of which an input is not finite or is rejected, -1 for none.
    """
    workspace = workspace_at(address)
    refused = -1
    for i in range(output.size):
        x[i, 0] = scale[i, 0] * e[i]
        x[i, 1] = scale[i, 1] * de[i]
        block[0] = output[i]
        fired = evaluate(address, x[i], block)
        output[i] = block[0]
        if fired < 0:
            refused = i
        else:
            counts[i, CLAMPED] += _is_clamped(workspace.clamped, x[i])
            counts[i, UNDEFINED] += workspace.undefined[0]
        _note_activity(workspace, fired, activity[i])
    return refused


@inlined_kernel
def _is_clamped(clamped, x):
    return int(clamped[0] != x[0] or clamped[1] != x[1])


@inlined_kernel
def _note_activity(workspace, fired, activity):
    for n in range(fired):
        rule = workspace.fired[n]
        activity[rule] = max(activity[rule], workspace.strength[rule])


@borrowing_kernel
def adaptive_blocks(
    address: int,
    law: Law,
    step: float,
    e: Array,
    de: Array,
    x: Array,
    basis: Array,
    weights: Array,
    learned: Array,
    output: Array,
    activity: Array,
    counts: NDArray[np.int64],
) -> int:
    """Write T = θᵀ ξ of every coordinate and adapt θ; equations (39)-(43).

    ξ = products of one degree of each input's sets, divided by their sum: of the edited sets (first type), or of
    Gaussian sets, as many, evenly spread over the inputs' ranges (second type). Rules and output sets play no part.

    Args:
        address: Of the compiled system and its workspace.
        law: Scales and rates.
        step: Control step, s; θ is advanced by Euler's rule.
        e: (2N,) error.
        de: (2N,) its rate.
        x: (2N, 2) out, the blocks' inputs.
        basis: (2 n_basis + 1,) overwritten: products of the last coordinate's degrees, then the degrees.
        weights: (2N, n_basis) θ in and out.
        learned: (2N,) out, |θ|² before the step.
        output: (2N,) out, T; NaN where an input is not finite or is rejected.
        activity: (2N, n_rules) in and out, the largest firing strength so far.
        counts: (2N, 2) in and out, how often an input was clamped, and how often no set has a degree, so that T is 0.

    Returns:
        A coordinate of which an input is not finite or is rejected, -1 for none.
    """
    refused = -1
    # ξ is 0 where no set has a degree. As many degrees as there are, r + c, are at most r c + 1.
    inputs = inputs_at(address)
    workspace = workspace_at(address)
    rows = inputs.term_start[1]
    columns = inputs.term_start[2] - rows
    size = rows * columns
    degrees = basis[size:]
    for i in range(output.size):
        x[i, 0] = law.scale[i, 0] * e[i]
        x[i, 1] = law.scale[i, 1] * de[i]
        if not membership.fuzzify(address, x[i]):
            output[i] = math.nan
            refused = i
            continue
        _note_activity(workspace, firing.fire(address), activity[i])
        if law.fuzzy == ADAPTED_GAUSSIANS:
            _gaussian_degrees(x[i, 0], inputs.range[0], degrees[:rows])
            _gaussian_degrees(x[i, 1], inputs.range[1], degrees[rows : rows + columns])
        else:
            for k in range(rows + columns):
                degrees[k] = workspace.membership[k]
        total = 0.0
        for row in range(rows):
            for column in range(columns):
                basis[row * columns + column] = degrees[row] * degrees[rows + column]
                total += basis[row * columns + column]
        share = 1.0 / total if total > 0.0 else 0.0
        counts[i, CLAMPED] += _is_clamped(workspace.clamped, x[i])
        counts[i, UNDEFINED] += int(total <= 0.0)
        rate = law.adaptation[0, i] * e[i] + law.adaptation[1, i] * de[i]
        value = 0.0
        squares = 0.0
        for k in range(size):
            weight = weights[i, k]
            degree = share * basis[k]
            value += weight * degree
            squares += weight * weight
            weights[i, k] = weight + step * (degree * rate - law.leak[i] * weight)
        output[i] = value
        learned[i] = squares
    return refused


@borrowing_kernel
def _gaussian_degrees(x: float, limits: Array, degrees: Array) -> None:
    """Write the degrees (n,) of n Gaussian sets, evenly spread over the limits; neighbours cross at 0.5."""
    spacing = (limits[1] - limits[0]) / max(degrees.size - 1, 1)
    value = min(max(x, limits[0]), limits[1])
    for k in range(degrees.size):
        distance = (value - limits[0]) / spacing - k
        degrees[k] = math.exp(-4.0 * math.log(2.0) * distance * distance)
