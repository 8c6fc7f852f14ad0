"""Fuzzy inference, slow and obvious: the definitions word by word, in exact or 40-digit arithmetic.

Written from the definitions alone: it shares no code with the kernels. Systems of triangles and trapezoids are
computed in fractions, so that their results are exact; one Gaussian anywhere makes all numbers mpmath's.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np

from fuzzy.shapes import Gaussian, Shape, Trapezoid, Triangle
from fuzzy.system import And, FuzzySystem, Is, Not, Or, Output, Rule, Sampling

Number = Any
"""Fraction or mpmath's mpf."""

DIGITS = 40

_context = mpmath.mp.clone()
_context.dps = DIGITS

number_of_curved: Callable[[float], Number] = _context.mpf
"""Number type where exponentials occur."""


def infer(system: FuzzySystem, *inputs: float, strengths: Sequence[float] | None = None) -> list[Number | None]:
    """Return the crisp outputs; None where no rule concludes on an output.

    Args:
        system: A valid system.
        *inputs: Crisp inputs.
        strengths: Firing strengths to begin with, in place of those that follow from the inputs.
    """
    number = number_of(system)
    rules = all_rules(system)
    found = firing_strengths(system, *inputs) if strengths is None else [number(strength) for strength in strengths]
    return [_defuzzify(system, output, _conclusions(rules, found, output), number) for output in system.outputs]


@functools.lru_cache(maxsize=4)
def number_of(system: FuzzySystem) -> Callable[[float], Number]:
    """Return the number type in which a system is computed."""
    shapes = [term.shape for variable in (*system.inputs, *system.outputs) for term in variable.terms]
    return number_of_curved if any(isinstance(shape, Gaussian) for shape in shapes) else Fraction


def all_rules(system: FuzzySystem) -> list[Rule]:
    """Return the cells of the table as rules, row by row, and the listed rules."""
    rules: list[Rule] = []
    table = system.rules.table
    if table is not None:
        by_name = {variable.name: variable for variable in system.inputs}
        for row, cells in zip(by_name[table.rows].terms, table.cells, strict=True):
            for column, cell in zip(by_name[table.columns].terms, cells, strict=True):
                if cell is not None:
                    antecedent = And((Is(table.rows, row.name), Is(table.columns, column.name)))
                    rules.append(Rule(antecedent, (Is(table.output, cell),)))
    return rules + list(system.rules.list)


def degree(shape: Shape, x: Number, number: Callable[[float], Number]) -> Number:
    """Return the membership degree of x."""
    match shape:
        case Triangle(a=a, b=b, c=c):
            return degree(Trapezoid(a, b, b, c), x, number)
        case Trapezoid(a=a, b=b, c=c, d=d):
            if number(b) <= x <= number(c):
                return number(1)
            if x < number(b):
                if math.isinf(a):
                    return number(1)
                return (x - number(a)) / (number(b) - number(a)) if x > number(a) else number(0)
            if math.isinf(d):
                return number(1)
            return (number(d) - x) / (number(d) - number(c)) if x < number(d) else number(0)
        case Gaussian(mean=mean, sigma=sigma):
            return _context.exp(-(((x - number(mean)) / number(sigma)) ** 2) / 2)


def firing_strengths(system: FuzzySystem, *inputs: float) -> list[Number]:
    """Return weight times degree of the antecedent for every rule; inputs outside their range count as its end."""
    number = number_of(system)
    degrees: dict[Is, Number] = {}
    for variable, x in zip(system.inputs, inputs, strict=True):
        clamped = min(max(number(x), number(variable.low)), number(variable.high))
        for term in variable.terms:
            degrees[Is(variable.name, term.name)] = degree(term.shape, clamped, number)
    operators = system.inference

    def value(expression: Any) -> Number:
        match expression:
            case Is():
                return degrees[expression]
            case Not(operand=operand):
                return 1 - value(operand)
            case And(operands=operands):
                return _fold(T_NORMS[operators.conjunction], [value(operand) for operand in operands])
            case Or(operands=operands):
                return _fold(S_NORMS[operators.disjunction], [value(operand) for operand in operands])
        raise AssertionError(expression)

    return [number(rule.weight) * value(rule.antecedent) for rule in all_rules(system)]


T_NORMS: dict[str, Callable[[Number, Number], Number]] = {
    "min": min,
    "product": lambda a, b: a * b,
    "bounded_difference": lambda a, b: max(a * 0, a + b - 1),
    "drastic_product": lambda a, b: b if a == 1 else a if b == 1 else a * 0,
    "einstein_product": lambda a, b: a * b / (2 - (a + b - a * b)),
    "hamacher_product": lambda a, b: a * b / (a + b - a * b) if a + b > 0 else a * 0,
    "nilpotent_minimum": lambda a, b: min(a, b) if a + b > 1 else a * 0,
}
S_NORMS: dict[str, Callable[[Number, Number], Number]] = {
    "max": max,
    "algebraic_sum": lambda a, b: a + b - a * b,
    "bounded_sum": lambda a, b: min(a * 0 + 1, a + b),
    "drastic_sum": lambda a, b: b if a == 0 else a if b == 0 else a * 0 + 1,
    "einstein_sum": lambda a, b: (a + b) / (1 + a * b),
    "hamacher_sum": lambda a, b: (a + b - 2 * a * b) / (1 - a * b) if a * b < 1 else a * 0 + 1,
    "nilpotent_maximum": lambda a, b: max(a, b) if a + b < 1 else a * 0 + 1,
    "sum": lambda a, b: a + b,
}


def _aggregation(system: FuzzySystem) -> str:
    """Return how the implied sets are joined: the center of sums (paper eq. (33)) adds them, whatever is chosen."""
    return "sum" if system.inference.defuzzifier == "center_of_sums" else system.inference.aggregation


def _fold(norm: Callable[[Number, Number], Number], values: list[Number]) -> Number:
    total = values[0]
    for value in values[1:]:
        total = norm(total, value)
    return total


def _conclusions(rules: list[Rule], strengths: list[Number], output: Output) -> list[tuple[Number, Shape]]:
    """Return strength and consequent set of every rule that fires and concludes on this output."""
    shapes = {term.name: term.shape for term in output.terms}
    return [
        (strength, shapes[consequent.term])
        for rule, strength in zip(rules, strengths, strict=True)
        for consequent in rule.consequents
        if consequent.variable == output.name and strength > 0
    ]


def aggregated(system: FuzzySystem, conclusions: list[tuple[Number, Shape]], u: Number) -> Number:
    """Return the degree of the aggregated set at u."""
    number = number_of(system)
    implication = T_NORMS[system.inference.implication]
    implied = [implication(strength, degree(shape, u, number)) for strength, shape in conclusions]
    return _fold(S_NORMS[_aggregation(system)], [number(0), *implied])


def _defuzzify(
    system: FuzzySystem, output: Output, conclusions: list[tuple[Number, Shape]], number: Callable[[float], Number]
) -> Number | None:
    if not conclusions:
        return None
    if isinstance(system.inference.resolution, Sampling):
        return _sampled_centroid(system, output, conclusions, number)
    curved = any(isinstance(shape, Gaussian) for _, shape in conclusions)
    parts = _curved_moments(system, output, conclusions) if curved else _moments(system, output, conclusions, number)
    area = sum(area for area, _ in parts)
    return sum(moment for _, moment in parts) / area if area > 0 else None


def _sampled_centroid(
    system: FuzzySystem, output: Output, conclusions: list[tuple[Number, Shape]], number: Callable[[float], Number]
) -> Number | None:
    resolution = system.inference.resolution
    assert isinstance(resolution, Sampling)
    low, width, n = number(output.low), number(output.high) - number(output.low), resolution.points
    if resolution.rule == "midpoints":
        samples = [low + width * (2 * i + 1) / (2 * n) for i in range(n)]
    else:
        samples = [low + width * i / (n - 1) for i in range(n)]
    degrees = [aggregated(system, conclusions, u) for u in samples]
    total = sum(degrees)
    return sum(u * degree for u, degree in zip(samples, degrees, strict=True)) / total if total > 0 else None


def _break_points(output: Output, conclusions: list[tuple[Number, Shape]], number: Callable[[float], Number]):
    """Return the ends of the range, all vertices of the sets, and where a set is as high as any strength."""
    points = {number(output.low), number(output.high)}
    for _, shape in conclusions:
        match shape:
            case Gaussian(mean=mean, sigma=sigma):
                points.add(number(mean))
                for level in {strength for strength, _ in conclusions if strength < 1}:
                    reach = _context.mpf(sigma) * _context.sqrt(-2 * _context.log(level))
                    points |= {number(mean) - number(reach), number(mean) + number(reach)}
            case Triangle(a=a, b=b, c=c):
                sides = [(a, b), (b, c)]
                points |= {number(value) for side in sides for value in side if math.isfinite(value)}
            case Trapezoid(a=a, b=b, c=c, d=d):
                points |= {number(value) for value in (a, b, c, d) if math.isfinite(value)}
    return sorted(u for u in points if number(output.low) <= u <= number(output.high))


def _moments(
    system: FuzzySystem, output: Output, conclusions: list[tuple[Number, Shape]], number: Callable[[float], Number]
) -> list[tuple[Number, Number]]:
    """Return area and moment of the aggregated set between all points where it could bend; exact.

    Between two vertices every set is a straight line, known from two inner points: at the vertices themselves it
    may jump. Where two of these lines, or one of them and the level of a strength, cross, the aggregated set may bend.
    """
    breaks = _break_points(output, conclusions, number)
    implication = T_NORMS[system.inference.implication]
    parts = []
    for left, right in itertools.pairwise(breaks):
        inner = [left + (right - left) / 4, right - (right - left) / 4]
        gains = [strength for strength, _ in conclusions]
        if implication is min:
            lines = [[degree(shape, u, number) for u in inner] for _, shape in conclusions]
            lines += [[gain, gain] for gain in gains]
        else:
            lines = [
                [gain * degree(shape, u, number) for u in inner]
                for gain, (_, shape) in zip(gains, conclusions, strict=True)
            ]
        bends = {left, right}
        for (a1, a2), (b1, b2) in itertools.combinations({tuple(line) for line in lines}, 2):
            if a2 - a1 != b2 - b1:
                share = (b1 - a1) / ((a2 - a1) - (b2 - b1))
                bend = inner[0] + share * (inner[1] - inner[0])
                if left < bend < right:
                    bends.add(bend)
        for start, end in itertools.pairwise(sorted(bends)):
            width, middle = end - start, (start + end) / 2
            first, second = (aggregated(system, conclusions, middle + side * width / 4) for side in (-1, 1))
            slope = (second - first) / (width / 2)
            area = width * (first + second) / 2
            parts.append((area, area * middle + slope * width**3 / 12))
    return parts


def bends(system: FuzzySystem, output: Output, conclusions: list[tuple[Number, Shape]]) -> list[float]:
    """Return the points between which the aggregated set is analytic and no Gaussian is hidden from a quadrature."""
    points = {float(u) for u in _break_points(output, conclusions, float)}
    levels = [float(strength) for strength, _ in conclusions]
    for _, shape in conclusions:
        if isinstance(shape, Gaussian):
            points |= {
                shape.mean + side * count * shape.sigma for side in (-1, 1) for count in (0.5, 1, 2, 4, 8, 16, 38)
            }
        elif isinstance(shape, Triangle | Trapezoid):
            a, b, c, d = _corners(shape)
            points |= {side + level * (top - side) for level in levels for side, top in ((a, b), (d, c))}
    found = sorted(u for u in points if output.low <= u <= output.high)
    if _aggregation(system) == "max":
        found = sorted({*found, *_handovers(system, conclusions, found)})
    return found


def _curved_moments(
    system: FuzzySystem, output: Output, conclusions: list[tuple[Number, Shape]]
) -> list[tuple[float, float]]:
    """Return area and moment of the aggregated set between all points where it could bend, in double precision.

    Between these points 40 Gauss-Legendre nodes are as good as exact; a test compares them with mpmath's quadrature.
    """
    nodes, weights = np.polynomial.legendre.leggauss(40)
    middle_of_range = 0.5 * (output.low + output.high)
    parts = []
    for start, end in itertools.pairwise(bends(system, output, conclusions)):
        u = 0.5 * (start + end) + 0.5 * (end - start) * nodes
        degrees = 0.5 * (end - start) * weights * _join(system, _implied(system, conclusions, u))
        area = math.fsum(degrees)
        parts.append((area, math.fsum(degrees * (u - middle_of_range)) + area * middle_of_range))
    return parts


def _corners(shape: Triangle | Trapezoid) -> tuple[float, float, float, float]:
    return (shape.a, shape.b, shape.b, shape.c) if isinstance(shape, Triangle) else (shape.a, shape.b, shape.c, shape.d)


def _implied(system: FuzzySystem, conclusions: list[tuple[Number, Shape]], u: np.ndarray) -> np.ndarray:
    """Return (n_conclusions, n) degrees of the implied sets, times 2**600 where all are tiny and would underflow."""
    scale = 2.0**600 if all(strength < 1e-200 for strength, _ in conclusions) else 1.0
    if system.inference.implication == "min":
        return np.array([scale * np.minimum(numpy_degrees(shape, u), float(level)) for level, shape in conclusions])
    return np.array([numpy_degrees(shape, u) * (scale * float(level)) for level, shape in conclusions])


def _join(system: FuzzySystem, implied: np.ndarray) -> np.ndarray:
    return implied.max(axis=0) if _aggregation(system) == "max" else implied.sum(axis=0)


def _handovers(system: FuzzySystem, conclusions: list[tuple[Number, Shape]], bends: list[float]) -> list[float]:
    """Return where another set begins to lead, found on a grid and then by bisection."""

    def leaders(u: np.ndarray) -> np.ndarray:
        return _implied(system, conclusions, u).argmax(axis=0)

    found: list[float] = []
    for left, right in itertools.pairwise(bends):
        grid = np.linspace(left, right, 201)
        leading = leaders(grid)
        for i in np.flatnonzero(leading[1:] != leading[:-1]):
            start, end = grid[i], grid[i + 1]
            for _ in range(60):
                middle = 0.5 * (start + end)
                if leaders(np.array([middle]))[0] == leading[i]:
                    start = middle
                else:
                    end = middle
            found.append(float(end))
    return found


def sampled_with_numpy(system: FuzzySystem, output: Output, strengths: Sequence[float]) -> float | None:
    """Return the sampled centroid of one output as a line of numpy would have it."""
    resolution = system.inference.resolution
    assert isinstance(resolution, Sampling)
    n = resolution.points
    if resolution.rule == "endpoints":
        u = np.linspace(output.low, output.high, n)
    else:
        u = output.low + (np.arange(n) + 0.5) * (output.high - output.low) / n
    conclusions = _conclusions(all_rules(system), list(strengths), output)
    if not conclusions:
        return None
    total = _join(system, _implied(system, conclusions, u))
    return float((u * total).sum() / total.sum()) if total.sum() > 0 else None


def numpy_degrees(shape: Shape, u: np.ndarray) -> np.ndarray:
    """Return the membership degrees of u."""
    match shape:
        case Gaussian(mean=mean, sigma=sigma):
            return np.exp(-(((u - mean) / sigma) ** 2) / 2)
        case Triangle(a=a, b=b, c=c):
            return numpy_degrees(Trapezoid(a, b, b, c), u)
        case Trapezoid(a=a, b=b, c=c, d=d):
            rise = np.ones_like(u) if math.isinf(a) else np.clip((u - a) / (b - a), 0, 1) if a < b else 1.0 * (u >= b)
            fall = np.ones_like(u) if math.isinf(d) else np.clip((d - u) / (d - c), 0, 1) if c < d else 1.0 * (u <= c)
            return np.minimum(rise, fall)
    raise AssertionError(shape)
