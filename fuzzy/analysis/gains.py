"""Slopes of the control surface: at one place, and as the PD law to which a controller is equivalent."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzy.analysis.places import Numbers, Place, cell_middles, check_count, number_of, place_of
from fuzzy.errors import InvalidInputError
from fuzzy.inference import Controller

_STEPS = 2.0 ** -np.arange(5, 27)
"""Steps of the differences as shares of the universe, coarse to fine."""

_SAME_BEND = 1e-7
"""Slopes, as shares of output range over input range, that differ by less are the same."""

_JUMP = 1e-6
"""Least jump, as a share of the output's range, that makes a slope infinite."""


class LocalGains(NamedTuple):
    """Slopes ∂y/∂x at one place, in the output's unit per the input's unit; all arrays are (n_out, n_in).

    A surface bends where a term begins, peaks or ends and where MIN or MAX changes sides, so there are two slopes.

    Attributes:
        left: Slope towards smaller inputs; NaN at the lower end of the universe, infinite at a jump.
        right: Slope towards greater inputs; NaN at the upper end, infinite at a jump.
        error: Estimated error of the worse of the two.
        bends: Whether the two slopes differ.
    """

    left: Numbers
    right: Numbers
    error: Numbers
    bends: NDArray[np.bool_]

    @property
    def gain(self) -> Numbers:
        """(n_out, n_in) mean of both slopes; at an end of the universe the one that exists."""
        left = np.where(np.isnan(self.left), self.right, self.left)
        return 0.5 * (left + np.where(np.isnan(self.right), self.left, self.right))


class EquivalentGains(NamedTuple):
    """The linear PD law T = Kp e + Kd ė that a fuzzy controller is near the origin, and how far it departs from it.

    Attributes:
        proportional: Kp = ∂T/∂e at the origin, mean of both sides, in T's unit per e's unit.
        derivative: Kd = ∂T/∂ė at the origin.
        bends: Whether the surface bends at the origin along e, along ė: the law is not linear there.
        mean_proportional: Mean of ∂T/∂e over the universe.
        mean_derivative: Mean of ∂T/∂ė over the universe.
        least_proportional: Least ∂T/∂e of all places tried; negative means that more error gives less torque.
        least_derivative: Least ∂T/∂ė.
        greatest_proportional: Greatest ∂T/∂e: what the loop's stability must bear.
        greatest_derivative: Greatest ∂T/∂ė.
    """

    proportional: float
    derivative: float
    bends: tuple[bool, bool]
    mean_proportional: float
    mean_derivative: float
    least_proportional: float
    least_derivative: float
    greatest_proportional: float
    greatest_derivative: float


def local_gains(controller: Controller, at: Place | None = None) -> LocalGains:
    """Return the slopes of every output along every input at one place.

    Each slope is a one-sided difference, extrapolated up to three times (Richardson), over steps from 1/32 of the
    universe down to 1.5e-8 of it; of all of them the one counts that agrees best with its coarser and its finer
    neighbours. A bend or a jump further away than the finest steps therefore leaves no trace, and nor does the noise
    of curved sets' quadrature. Where the surface is smooth over 1e-3 of the universe, the error is below 1e-9 of the
    output's range over the input's; it grows as a bend comes nearer. ``error`` says what it is.

    Args:
        controller: The compiled system.
        at: The place; mid-range by default.

    Raises:
        InvalidInputError: A place outside the universe, or that cannot be used.
    """
    place = place_of(controller.system, at)
    for variable, value in zip(controller.system.inputs, place, strict=True):
        if not variable.low <= value <= variable.high:
            raise InvalidInputError(
                f"no slope at {value:g}; valid: {variable.low:g} to {variable.high:g}", variable.name
            )
    n_out, n_in = len(controller.system.outputs), len(controller.system.inputs)
    left, right, error = np.empty((3, n_out, n_in))
    bends = np.empty((n_out, n_in), dtype=np.bool_)
    for k, variable in enumerate(controller.system.inputs):
        both = [_slopes(controller, place[np.newaxis], k, side) for side in (-1.0, 1.0)]
        left[:, k], right[:, k] = both[0][0][0], both[1][0][0]
        errors = np.array([both[0][1][0], both[1][1][0]])
        error[:, k] = np.fmax(*errors)
        for n, out in enumerate(controller.system.outputs):
            same = errors[:, n].sum() + _SAME_BEND * (out.high - out.low) / (variable.high - variable.low)
            # Two infinite slopes of one sign are a jump, which is no straight line either.
            difference = abs(right[n, k] - left[n, k])
            jumps = math.isinf(left[n, k]) or math.isinf(right[n, k])
            bends[n, k] = jumps or difference > same
    return LocalGains(left, right, error, bends)


def equivalent_gains(controller: Controller, output: str | None = None, points: int = 41) -> EquivalentGains:
    """Return the PD gains that a controller with the inputs e and ė, in this order, is equivalent to at the origin.

    The means are exact along each input, being differences of the universe's ends (a jump counts as the slope it
    stands for); least and greatest come from the slopes in the middle of ``points`` x ``points`` cells, jumps left
    out.

    Args:
        controller: The compiled system; two inputs whose ranges contain 0.
        output: Name of the output; the first by default.
        points: Cells along each input, from 2 to 201.

    Raises:
        InvalidInputError: Not two inputs, no origin in their ranges, an unknown output, ``points`` out of range.
    """
    system = controller.system
    if len(system.inputs) != 2:
        raise InvalidInputError(f"{len(system.inputs)} inputs; valid: two, the error and its rate")
    number = number_of(output, system.outputs, "output")
    check_count(points, 201)
    origin = local_gains(controller, (0.0, 0.0))
    middles = cell_middles(system.inputs, points)
    means, least, greatest = [], [], []
    for k, variable in enumerate(system.inputs):
        ends = middles[:points].copy() if k == 0 else middles[::points].copy()
        ends = np.tile(ends, (2, 1))
        ends[:points, k], ends[points:, k] = variable.low, variable.high
        value = controller.batch(ends)[:, number].reshape(2, points)
        means.append(_summary(np.mean, (value[1] - value[0]) / (variable.high - variable.low)))
        slopes = np.concatenate([_slopes(controller, middles, k, side)[0][:, number] for side in (-1.0, 1.0)])
        slopes[np.isinf(slopes)] = math.nan
        least.append(_summary(np.min, slopes))
        greatest.append(_summary(np.max, slopes))
    gain = origin.gain[number]
    bends = (bool(origin.bends[number, 0]), bool(origin.bends[number, 1]))
    return EquivalentGains(float(gain[0]), float(gain[1]), bends, *means, *least, *greatest)


def _slopes(controller: Controller, x: Numbers, k: int, side: float) -> tuple[Numbers, Numbers]:
    """Return one-sided slopes along input ``k`` at every row of ``x``, and their estimated errors, (n, n_out) each.

    Args:
        controller: The compiled system.
        x: (n, n_in) places within the universe.
        k: Number of the input.
        side: -1 or 1.
    """
    variable = controller.system.inputs[k]
    width = variable.high - variable.low
    n, n_out, n_steps = len(x), len(controller.system.outputs), _STEPS.size
    room = variable.high - x[:, k] if side > 0 else x[:, k] - variable.low
    places = x[:, k] + side * np.minimum(width * _STEPS[0], room) * (_STEPS / _STEPS[0])[:, np.newaxis]
    rows = np.tile(x, (n_steps, 1))
    rows[:, k] = np.clip(places, variable.low, variable.high).ravel()
    here = controller.batch(x)
    there = controller.batch(rows).reshape(n_steps, n, n_out)
    step = (rows[:, k].reshape(n_steps, n) - x[:, k])[:, :, np.newaxis]  # as rounded
    with np.errstate(all="ignore"):  # NaN and no room are results
        table = [(there - here) / step]
        table.append(2.0 * table[0][1:] - table[0][:-1])
        table.append((4.0 * table[1][1:] - table[1][:-1]) / 3.0)
        table.append((8.0 * table[2][1:] - table[2][:-1]) / 7.0)
        slope, error = _best(table, _round_off(controller, here) / abs(step))
        # The limit from this side; where it is not the value here, the surface jumps.
        jump = 2.0 * there[-1] - there[-2] - here
    ranges = np.array([output.high - output.low for output in controller.system.outputs])
    jumps = abs(jump) > _JUMP * ranges
    slope[jumps] = side * np.copysign(math.inf, jump[jumps])
    error[jumps] = 0.0
    outside = room < width * _STEPS[0] * _STEPS[-1]
    slope[outside], error[outside] = math.nan, math.nan
    return slope, error


def _round_off(controller: Controller, value: Numbers) -> Numbers:
    """Return the error of a difference of two outputs that rounding explains, (n, n_out)."""
    scale = np.array([max(abs(output.low), abs(output.high)) for output in controller.system.outputs])
    return 8.0 * np.finfo(np.float64).eps * np.fmax(scale, abs(value))


def _best(table: list[Numbers], noise: Numbers) -> tuple[Numbers, Numbers]:
    """Return the entries of an extrapolation table that can be trusted most, and their estimated errors.

    An entry's error is how far it is from the next coarser step and from the next finer one, as far as rounding does
    not explain that, plus its own rounding error. Agreement on both sides is needed: a bend within a step can make
    two neighbours agree by chance.

    Args:
        table: Columns of orders 1 to 4, each (n_steps - order + 1, n, n_out), coarse to fine.
        noise: (n_steps, n, n_out) rounding error of a slope with each step.
    """
    amplification = (1.0, 3.0, 5.0, 6.5)  # of rounding by each column, from the weights of its extrapolation
    values, errors = [], []
    for order, column in enumerate(table):
        own = amplification[order] * noise[order:]
        change = abs(np.diff(column, axis=0))
        middle = np.fmax(0.0, np.maximum(change[:-1], change[1:] - own[2:] - own[1:-1])) + own[1:-1]
        values.append(column[1:-1])
        errors.append(np.where(np.isnan(change[:-1] + change[1:]), math.inf, middle))
    value, error = np.concatenate(values), np.concatenate(errors)
    chosen = np.argmin(error, axis=0)[np.newaxis]
    slope = np.take_along_axis(value, chosen, axis=0)[0]
    error = np.take_along_axis(error, chosen, axis=0)[0]
    slope[np.isinf(error)] = math.nan
    return slope, np.where(np.isinf(error), math.nan, error)


def _summary(statistic, values: Numbers) -> float:
    """Return a statistic of the values that are defined; NaN when none is."""
    known = values[~np.isnan(values)]
    return float(statistic(known)) if known.size else math.nan
