"""How much each rule moved an output."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzy import rules
from fuzzy.analysis.places import Numbers, number_of
from fuzzy.errors import InvalidInputError
from fuzzy.inference import Controller
from fuzzy.kernels import contributions as kernels
from fuzzy.system import Rule

MOST = 6
"""Rules that are told apart, the strongest; all weaker ones count together."""

OTHERS = -2
"""Number that stands for all weaker rules together."""


class Contribution(NamedTuple):
    """What one rule did.

    Attributes:
        number: As in ``fuzzy.rules.all_rules``; ``OTHERS`` for all weaker rules together.
        rule: The rule; None for all weaker ones.
        strength: Firing strength, in [0, 1]; 0 for all weaker ones.
        moved: How far it moved the output, in its unit.
    """

    number: int
    rule: Rule | None
    strength: float
    moved: float


class Contributions(NamedTuple):
    """How an output came about, rule by rule.

    Attributes:
        output: Name of the output.
        base: What it is when no rule fires: the default, the start value of the hold policy, or mid-range.
        value: What it is.
        rules: What moved it from the one to the other, the greatest first; the sum of all is ``value`` - ``base``.
    """

    output: str
    base: float
    value: float
    rules: tuple[Contribution, ...]


class Shares(NamedTuple):
    """The same for many inputs, as arrays.

    Attributes:
        value: (n,) the output.
        moved: (n_rules,) sum over all inputs of how far each rule moved the output, times the inputs' weights.
    """

    value: Numbers
    moved: Numbers


def contributions(controller: Controller, x: ArrayLike, output: str | None = None) -> Contributions:
    """Return how far each rule that fires moved an output.

    These are Shapley values: the mean, over all orders in which the rules may come, of the change when a rule comes.
    Under a centroid rules pull at each other, so that the change by leaving one out would depend on the order.

    Args:
        controller: The compiled system.
        x: (n_in,) crisp inputs.
        output: Name of the output; the first by default.

    Raises:
        InvalidInputError: Inputs that ``Controller.batch`` refuses, or an unknown output.

    References:
        L. S. Shapley, "A value for n-person games" (1953).
    """
    row = np.asarray(x, dtype=np.float64)[np.newaxis]
    number = number_of(output, controller.system.outputs, "output")
    base, rule, moved, value, strength = _share_out(controller, row, number)
    numbered = rules.all_rules(controller.system)
    found = [
        Contribution(int(n), numbered[n] if n >= 0 else None, float(strength[n]) if n >= 0 else 0.0, float(change))
        for n, change in zip(rule[0], moved[0], strict=True)
        if n != -1
    ]
    ordered = tuple(sorted(found, key=lambda one: -abs(one.moved)))
    return Contributions(controller.system.outputs[number].name, base, float(value[0]), ordered)


def shares(controller: Controller, x: ArrayLike, weights: ArrayLike, output: str | None = None) -> Shares:
    """Return how far each rule moved an output in all, over many inputs such as those of a run.

    Args:
        controller: The compiled system.
        x: (n, n_in) crisp inputs, one inference a row.
        weights: (n,) what a row counts.
        output: Name of the output; the first by default.

    Raises:
        InvalidInputError: As for :func:`contributions`.
    """
    rows = np.ascontiguousarray(x, dtype=np.float64)
    number = number_of(output, controller.system.outputs, "output")
    _, rule, moved, value, _ = _share_out(controller, rows, number)
    weighted = moved * np.asarray(weights, dtype=np.float64)[:, np.newaxis]
    total = np.zeros(len(rules.all_rules(controller.system)))
    known = rule >= 0
    np.add.at(total, rule[known], weighted[known])
    return Shares(value, total)


def _share_out(
    controller: Controller, rows: Numbers, number: int
) -> tuple[float, NDArray[np.int64], Numbers, Numbers, Numbers]:
    """Return base, rules, how far each moved the output, the output, and the last row's firing strengths."""
    n_in = len(controller.system.inputs)
    if rows.ndim != 2 or rows.shape[1] != n_in:
        raise InvalidInputError(f"inputs of shape {rows.shape}; valid: (n, {n_in})")
    controller.batch(rows)  # refuses what cannot be used
    own = controller.directory()
    start = np.array(controller.tables.outputs.no_fire_value)
    variable = controller.system.outputs[number]
    base = float(start[number]) if math.isfinite(start[number]) else 0.5 * variable.low + 0.5 * variable.high
    rule = np.empty((len(rows), MOST + 1), dtype=np.int64)
    moved = np.empty((len(rows), MOST + 1))
    value = np.empty(len(rows))
    order = np.zeros(max(1, own.workspace.strength.size), dtype=np.int64)
    scratch = np.empty(1 << (MOST + 1))
    kernels.share_out(own.address, np.ascontiguousarray(rows), number, start, base, order, _WEIGHTS, scratch,
                      rule, moved, value)  # fmt: skip
    return base, rule, moved, value, own.workspace.strength.copy()


def _weights() -> Numbers:
    """Return |S|! (n - |S| - 1)! / n! for n players and coalitions of size |S|."""
    table = np.zeros((MOST + 2, MOST + 1))
    for n in range(1, MOST + 2):
        for size in range(n):
            table[n, size] = math.factorial(size) * math.factorial(n - size - 1) / math.factorial(n)
    return table


_WEIGHTS = _weights()
