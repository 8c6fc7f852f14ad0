"""How far an output goes, and why not further."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from fuzzy import sets, shapes
from fuzzy.analysis.places import SAMPLES, Numbers, number_of, spread
from fuzzy.errors import InvalidInputError
from fuzzy.inference import Controller, compile_system
from fuzzy.system import FuzzySystem, Input, Is, Output, Rule, RuleBase, Term


class Reach(NamedTuple):
    """Least and greatest value of one output, and why it cannot go further.

    Attributes:
        low: Lower end of the output's range.
        high: Upper end.
        least: Least output found.
        greatest: Greatest output found.
        least_at: (n_in,) inputs that give the least output.
        greatest_at: (n_in,) inputs that give the greatest.
        alone: The output that each term gives when it alone is concluded, at full strength. A centroid lies inside
            its set, so a triangle whose peak is the range's end gives less than the end; that it reaches past the
            range does not help, as only the part within the range counts. NaN for a term without an area there.
    """

    low: float
    high: float
    least: float
    greatest: float
    least_at: Numbers
    greatest_at: Numbers
    alone: Mapping[str, float]


def output_range(controller: Controller, output: str | None = None) -> Reach:
    """Return the least and the greatest value that an output reaches, and what each of its terms gives alone.

    The search tries a grid with all break points of the inputs' terms, and from the best places on walks uphill
    along the inputs with ever smaller steps.

    Args:
        controller: The compiled system.
        output: Name of the output; the first by default.

    Raises:
        InvalidInputError: An unknown output, or one that is undefined everywhere.
    """
    system = controller.system
    number = number_of(output, system.outputs, "output")
    variable = system.outputs[number]
    start = _search_grid(system.inputs)
    value = controller.batch(start)[:, number]
    if np.isnan(value).all():
        raise InvalidInputError("no rule fires anywhere, so it has no value", variable.name)
    least_at, least = _climb(controller, start, value, number, -1.0)
    greatest_at, greatest = _climb(controller, start, value, number, 1.0)
    alone = {term.name: _alone(system, variable, term.name) for term in variable.terms}
    return Reach(variable.low, variable.high, least, greatest, least_at, greatest_at, alone)


def _climb(controller: Controller, start: Numbers, value: Numbers, number: int, sign: float) -> tuple[Numbers, float]:
    """Return the place and the value of the greatest ``sign`` times output ``number``, by compass search."""
    low = np.array([variable.low for variable in controller.system.inputs])
    high = np.array([variable.high for variable in controller.system.inputs])
    height = np.where(np.isnan(value), -math.inf, sign * value)
    best = np.argsort(-height, kind="stable")[:8]
    place, height = start[best].copy(), height[best].copy()
    n_in = len(low)
    directions = np.concatenate([np.eye(n_in), -np.eye(n_in)])
    step = 0.125
    while step > 1e-10:
        tried = np.clip(place[:, np.newaxis] + step * (high - low) * directions, low, high)
        found = sign * controller.batch(tried.reshape(-1, n_in))[:, number].reshape(len(place), -1)
        found = np.where(np.isnan(found), -math.inf, found)
        way = np.argmax(found, axis=1)
        top = found[np.arange(len(place)), way]
        better = top > height
        place[better] = tried[np.flatnonzero(better), way[better]]
        height[better] = top[better]
        if not better.any():
            step /= 2.0
    winner = int(np.argmax(height))
    return place[winner], float(sign * height[winner])


def _alone(system: FuzzySystem, output: Output, term: str) -> float:
    """Return an output when one of its terms alone is concluded at full strength."""
    always = Input("always", 0.0, 1.0, (Term("true", shapes.Trapezoid(-math.inf, 0.0, 1.0, math.inf)),))
    rule = Rule(Is("always", "true"), (Is(output.name, term),))
    lone = FuzzySystem("alone", (always,), (output,), RuleBase(list=(rule,)), system.inference)
    return float(compile_system(lone).batch([[0.5]])[0, 0])


def _search_grid(inputs: tuple[Input, ...]) -> Numbers:
    """Return places to begin a search from: all break points and ends of the inputs, and an even grid between."""
    per_input = max(3, int(SAMPLES ** (1.0 / len(inputs))))
    axes = []
    for variable in inputs:
        points = {variable.low, variable.high}
        for term in variable.terms:
            points.update(u for u in sets.break_points(term) if variable.low < u < variable.high)
        axes.append(np.union1d(sorted(points), np.linspace(variable.low, variable.high, min(per_input, 65))))
    if math.prod(len(axis) for axis in axes) <= 4 * SAMPLES:
        return np.stack([grid.ravel() for grid in np.meshgrid(*axes, indexing="ij")], axis=1)
    # Too many for a grid: evenly spread places, each moved to the nearest of the axes' points.
    places = spread(inputs, SAMPLES)
    for k, axis in enumerate(axes):
        nearest = np.clip(np.searchsorted(axis, places[:, k]), 1, len(axis) - 1)
        left = places[:, k] - axis[nearest - 1] < axis[nearest] - places[:, k]
        places[:, k] = axis[nearest - left]
    return places
