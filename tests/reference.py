"""Fuzzy inference, slow and obvious: the definitions word by word, in exact or 40-digit arithmetic.

Written from the definitions alone: it shares no code with the kernels. Systems of piecewise-linear sets are computed in
fractions, so that their results are exact; one curved set anywhere makes all numbers mpmath's. How output sets are
defuzzified is in ``reference_sets``.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

import mpmath

from fuzzy.shapes import (
    Bell,
    Concave,
    Cosine,
    Gaussian,
    Gaussian2,
    PiShape,
    Points,
    Ramp,
    Rectangle,
    Shape,
    Sigmoid,
    SigmoidDifference,
    SigmoidProduct,
    Singleton,
    Spike,
    SShape,
    Trapezoid,
    Triangle,
    ZShape,
)
from fuzzy.system import And, FuzzySystem, Hedged, Is, Not, Or, Output, Rule, Term

Number = Any
"""Fraction or mpmath's mpf."""

Conclusion = tuple[Number, Term]
"""Strength of a rule and the term that it concludes."""

DIGITS = 40

_context = mpmath.mp.clone()
_context.dps = DIGITS

exact = functools.lru_cache(maxsize=4096)(Fraction)
"""Number type of straight sets; a shape's few parameters are asked for again and again."""

number_of_curved: Callable[[float], Number] = _context.mpf
"""Number type where exponentials occur."""

STRAIGHT = (Triangle, Trapezoid, Rectangle, Ramp, Singleton, Points)


@functools.lru_cache(maxsize=4)
def number_of(system: FuzzySystem) -> Callable[[float], Number]:
    """Return the number type in which a system is computed."""
    terms = [term for variable in (*system.inputs, *system.outputs) for term in variable.terms]
    hedges = any(isinstance(e, Hedged) for rule in system.rules.list for e in _nodes(rule.antecedent))
    is_straight = all(isinstance(term.shape, STRAIGHT) for term in terms)
    return exact if is_straight and not hedges else number_of_curved


def _nodes(expression: Any) -> list[Any]:
    match expression:
        case Is():
            return [expression]
        case Not(operand=operand) | Hedged(operand=operand):
            return [expression, *_nodes(operand)]
        case _:
            return [expression, *(node for operand in expression.operands for node in _nodes(operand))]


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


def term_degree(term: Term, x: Number, number: Callable[[float], Number]) -> Number:
    """Return the degree of x in a term's set."""
    found = degree(term.shape, x, number)
    return number(term.height) * (1 - found if term.complement else found)


def degree(shape: Shape, x: Number, number: Callable[[float], Number]) -> Number:  # noqa: C901
    """Return the membership degree of x."""
    exp, one, zero = _context.exp, number(1), number(0)
    match shape:
        case Triangle(a=a, b=b, c=c):
            return _on_trapezoid(a, b, b, c, x, number)
        case Rectangle(a=a, b=b):
            return one if a <= x <= b else zero
        case Singleton(value=value):
            return one if x == number(value) else zero
        case Ramp(start=start, end=end):
            share = (x - number(start)) / (number(end) - number(start))
            return min(max(share, zero), one)
        case Points(points=points):
            return _on_points([(number(place), number(found)) for place, found in points], x)
        case Trapezoid(a=a, b=b, c=c, d=d):
            return _on_trapezoid(a, b, c, d, x, number)
        case Gaussian(mean=mean, sigma=sigma):
            return exp(-(((x - number(mean)) / number(sigma)) ** 2) / 2)
        case Gaussian2(left_mean=left, left_sigma=left_sigma, right_mean=right, right_sigma=right_sigma):
            rise = degree(Gaussian(left, left_sigma), x, number) if x < left else one
            return rise * (degree(Gaussian(right, right_sigma), x, number) if x > right else one)
        case Bell(center=center, width=width, slope=slope):
            return 1 / (1 + abs((x - number(center)) / number(width)) ** (2 * number(slope)))
        case Sigmoid(center=center, slope=slope):
            return 1 / (1 + exp(-number(slope) * (x - number(center))))
        case SigmoidDifference(left_center=a, left_slope=b, right_center=c, right_slope=d):
            return abs(degree(Sigmoid(a, b), x, number) - degree(Sigmoid(c, d), x, number))
        case SigmoidProduct(left_center=a, left_slope=b, right_center=c, right_slope=d):
            return degree(Sigmoid(a, b), x, number) * degree(Sigmoid(c, d), x, number)
        case SShape(a=a, b=b):
            if x >= b:
                return one
            share = (x - number(a)) / (number(b) - number(a)) if x > a else zero
            return 2 * share**2 if 2 * share <= 1 else 1 - 2 * (1 - share) ** 2
        case ZShape(a=a, b=b):
            return degree(SShape(-b, -a), -x, number)
        case PiShape(a=a, b=b, c=c, d=d):
            return degree(SShape(a, b), x, number) * degree(ZShape(c, d), x, number)
        case Cosine(center=center, width=width):
            share = (x - number(center)) / number(width)
            return (1 + _context.cos(2 * _context.pi * share)) / 2 if 2 * abs(share) <= 1 else zero
        case Spike(center=center, width=width):
            return exp(-abs(10 / number(width) * (x - number(center))))
        case Concave(inflection=inflection, end=end):
            is_before = x < end if inflection < end else x > end
            length = abs(number(end) - number(inflection))
            return length / (length + abs(number(end) - x)) if is_before else one
    raise AssertionError(shape)


def _on_trapezoid(a: float, b: float, c: float, d: float, x: Number, number: Callable[[float], Number]) -> Number:
    top_left, top_right = number(b), number(c)
    if x < top_left:
        if math.isinf(a):
            return number(1)
        left = number(a)
        return (x - left) / (top_left - left) if x > left else number(0)
    if x > top_right:
        if math.isinf(d):
            return number(1)
        right = number(d)
        return (right - x) / (right - top_right) if x < right else number(0)
    return number(1)


def _on_points(points: list[tuple[Number, Number]], x: Number) -> Number:
    here = [found for place, found in points if place == x]
    if here:
        return max(here)
    left = [point for point in points if point[0] < x]
    right = [point for point in points if point[0] > x]
    if not left or not right:
        return (left or right[:1])[-1][1]
    (x1, y1), (x2, y2) = left[-1], right[0]
    return y1 + (x - x1) / (x2 - x1) * (y2 - y1)


def firing_strengths(system: FuzzySystem, *inputs: float) -> list[Number]:
    """Return weight times degree of the antecedent for every rule; inputs outside their range count as its end."""
    number = number_of(system)
    degrees: dict[Is, Number] = {}
    for variable, x in zip(system.inputs, inputs, strict=True):
        clamped = min(max(number(x), number(variable.low)), number(variable.high))
        for term in variable.terms:
            degrees[Is(variable.name, term.name)] = term_degree(term, clamped, number)
    operators = system.inference
    joined = S_NORMS[operators.aggregation] if operators.aggregation != "min" else max
    activated: dict[Is, Number] = {}

    def value(expression: Any) -> Number:
        match expression:
            case Is():
                return degrees[expression] if expression in degrees else min(activated.get(expression, 0), 1)
            case Not(operand=operand):
                return 1 - value(operand)
            case Hedged(operand=operand, hedge=hedge):
                return HEDGES[hedge](value(operand))
            case And(operands=operands):
                return _fold(T_NORMS[operators.conjunction], [value(operand) for operand in operands])
            case Or(operands=operands):
                return _fold(S_NORMS[operators.disjunction], [value(operand) for operand in operands])
        raise AssertionError(expression)

    found = []
    for rule in all_rules(system):
        found.append(number(rule.weight) * value(rule.antecedent))
        for consequent in rule.consequents:
            activated[consequent] = joined(activated.get(consequent, number(0)), found[-1])
    return found


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
    "min": min,
}
"""Norms and aggregations."""

IMPLICATIONS = T_NORMS | {
    "bounded_sum": S_NORMS["bounded_sum"],
    "algebraic_sum": S_NORMS["algebraic_sum"],
    "kleene_dienes": lambda w, a: max(1 - w, a),
}

HEDGES: dict[str, Callable[[Number], Number]] = {
    "very": lambda a: a**2,
    "extremely": lambda a: a**3,
    "somewhat": lambda a: _context.sqrt(a),
    "more_or_less": lambda a: _context.cbrt(a),
    "plus": lambda a: a ** _context.mpf("1.25"),
    "intensify": lambda a: 2 * a**2 if 2 * a <= 1 else 1 - 2 * (1 - a) ** 2,
    "seldom": lambda a: _context.sqrt(a / 2) if 2 * a <= 1 else 1 - _context.sqrt((1 - a) / 2),
    "any": lambda a: a * 0 + 1,
}


def aggregation(system: FuzzySystem) -> str:
    """Return how the implied sets are joined: the center of sums (paper eq. (33)) adds them, whatever is chosen."""
    return "sum" if system.inference.defuzzifier == "center_of_sums" else system.inference.aggregation


def _fold(norm: Callable[[Number, Number], Number], values: Sequence[Number]) -> Number:
    total = values[0]
    for value in values[1:]:
        total = norm(total, value)
    return total


def conclusions_of(rules: list[Rule], strengths: list[Number], output: Output) -> list[Conclusion]:
    """Return strength and term of every rule that fires and concludes on this output."""
    terms = {term.name: term for term in output.terms}
    return [
        (strength, terms[consequent.term])
        for rule, strength in zip(rules, strengths, strict=True)
        for consequent in rule.consequents
        if consequent.variable == output.name and strength > 0
    ]


def aggregated(
    system: FuzzySystem, conclusions: list[Conclusion], u: Number, number: Callable[[float], Number]
) -> Number:
    """Return the degree of the aggregated set at u."""
    implication = IMPLICATIONS[system.inference.implication]
    implied = [implication(strength, term_degree(term, u, number)) for strength, term in conclusions]
    return _fold(S_NORMS[aggregation(system)], implied)
