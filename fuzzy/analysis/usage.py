"""Where rules fire, and how much each takes part."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzy import rules
from fuzzy.analysis.places import SAMPLES, Numbers, cell_middles, check_count, spread
from fuzzy.errors import InvalidInputError
from fuzzy.inference import Controller
from fuzzy.kernels import activity


class Coverage(NamedTuple):
    """Where rules fire.

    Attributes:
        share: Share of the input space in which at least one rule fires, in [0, 1].
        output_shares: The same for the rules that conclude on one output, by its name.
        samples: How many places were tried, evenly spread.
        silent: (m, n_in) the places tried at which some output has no rule that fires.
    """

    share: float
    output_shares: Mapping[str, float]
    samples: int
    silent: Numbers


class RuleUsage(NamedTuple):
    """How much each rule takes part; rules are numbered as in ``fuzzy.rules.all_rules``.

    Attributes:
        greatest: (n_rules,) greatest firing strength, in [0, 1].
        mean: (n_rules,) mean firing strength over all inputs.
        share: (n_rules,) share of the inputs at which the rule fires.
    """

    greatest: Numbers
    mean: Numbers
    share: Numbers


def coverage(controller: Controller, points: int | None = None) -> Coverage:
    """Return in which share of the input space rules fire, and where none does.

    Args:
        controller: The compiled system.
        points: Cells along each input, whose middles are tried; by default as many as make about 65,000 in all.

    Raises:
        InvalidInputError: ``points`` that make no grid, or one of more than 16 million places.
    """
    system = controller.system
    if points is not None:
        check_count(points, 2**24)
        if points ** len(system.inputs) > 2**24:
            raise InvalidInputError(
                f"{points} points along each of {len(system.inputs)} inputs; valid: up to 16777216 places in all"
            )
    x = cell_middles(system.inputs, points) if points is not None else spread(system.inputs, SAMPLES)
    *_, speaks = _observe(controller, x)
    shares = {variable.name: float(speaks[:, n].mean()) for n, variable in enumerate(system.outputs)}
    return Coverage(float(speaks.any(axis=1).mean()), shares, len(x), x[~speaks.all(axis=1)])


def rule_usage(controller: Controller, x: ArrayLike) -> RuleUsage:
    """Return how much each rule takes part over given inputs, such as those of a run.

    Args:
        controller: The compiled system.
        x: (n, n_in) crisp inputs, one inference a row, n > 0.

    Raises:
        InvalidInputError: Inputs that ``Controller.batch`` refuses, or none.
    """
    rows = np.ascontiguousarray(x, dtype=np.float64)
    if rows.ndim != 2 or len(rows) == 0:
        raise InvalidInputError(f"inputs of shape {rows.shape}; valid: (n, {len(controller.system.inputs)}), n > 0")
    controller.batch(rows)  # refuses what cannot be used
    greatest, total, count, _ = _observe(controller, rows)
    return RuleUsage(greatest, total / len(rows), count / len(rows))


def _observe(controller: Controller, x: Numbers) -> tuple[Numbers, Numbers, NDArray[np.int64], NDArray[np.bool_]]:
    """Return what ``activity.observe`` finds at every row of ``x``, which holds finite numbers."""
    system = controller.system
    numbered = rules.all_rules(system)
    names = [variable.name for variable in system.outputs]
    concludes = np.zeros((len(numbered), len(names)), dtype=np.bool_)
    for n, rule in enumerate(numbered):
        for consequent in rule.consequents:
            concludes[n, names.index(consequent.variable)] = True
    greatest, total = np.zeros((2, len(numbered)))
    count = np.zeros(len(numbered), dtype=np.int64)
    speaks = np.zeros((len(x), len(names)), dtype=np.bool_)
    own = controller.directory()
    activity.observe(own.address, x, np.zeros(len(names)), concludes, greatest, total, count, speaks)
    return greatest, total, count, speaks
