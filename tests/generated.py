"""Generated fuzzy systems by the thousand: seeded, quicker than hypothesis, and full of corner cases."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any, get_args

import numpy as np
from msgspec.structs import replace

from fuzzy import sets
from fuzzy.conversion import converted
from fuzzy.errors import InvalidSystemError
from fuzzy.limits import MIN_RELATIVE_WIDTH
from fuzzy.shapes import (
    SHAPES,
    Gaussian,
    Points,
    Ramp,
    Rectangle,
    Shape,
    Trapezoid,
    Triangle,
    kind,
    locations,
)
from fuzzy.system import (
    And,
    Expression,
    FuzzySystem,
    Hedge,
    Hedged,
    Inference,
    Input,
    Is,
    NoFire,
    Not,
    Or,
    Output,
    Rule,
    RuleBase,
    RuleTable,
    Term,
)
from fuzzy.validation.shapes import validate_shape

Generator = np.random.Generator
Range = tuple[float, float]

_TOWARDS = 1e-6


def systems(
    count: int, seed: int, *, curved: bool = False, ordered: bool = False, varied: bool = False, **operators
) -> Iterator[FuzzySystem]:
    """Yield valid systems.

    Args:
        count: How many.
        seed: Of the random numbers.
        curved: Whether some sets are Gaussians.
        ordered: Whether of every output's sets only neighbours overlap.
        varied: Whether the sets are of all kinds, with heights and complements, and rules have hedges and name outputs.
        operators: Fields of ``Inference``; the others are drawn.
    """
    random = np.random.default_rng(seed)
    for number in range(count):
        found = system(random, f"generated {number}", curved=curved, ordered=ordered, **operators)
        yield _varied(random, found, curved=curved) if varied else found


def _varied(random: Generator, found: FuzzySystem, *, curved: bool) -> FuzzySystem:
    """Return a system with some terms of other kinds, with heights and complements, and some hedges and outputs."""
    inputs = tuple(replace(v, terms=tuple(_other(random, v, t, curved=curved) for t in v.terms)) for v in found.inputs)
    outputs = []
    for output in found.outputs:
        terms = tuple(_other(random, output, term, curved=curved) for term in output.terms)
        ends = (sets.support(term, output.low, output.high) for term in terms)
        has_areas = [right - left > 0.01 * (output.high - output.low) for left, right in ends]
        pairs = zip(terms, output.terms, has_areas, strict=True)
        outputs.append(replace(output, terms=tuple(new if has_area else old for new, old, has_area in pairs)))
    rules = [replace(found.rules.list[0])]
    for rule in found.rules.list[1:]:
        antecedent = rule.antecedent
        kind = random.integers(6)
        if kind == 0 and curved:  # hedges take roots, which fractions have not
            antecedent = Hedged(antecedent, _one(random, get_args(Hedge)))
        elif kind == 1:
            antecedent = Or((antecedent, _proposition(random, found.outputs)))
        rules.append(replace(rule, antecedent=antecedent))
    rule_base = replace(found.rules, list=tuple(rules))
    return replace(found, inputs=inputs, outputs=tuple(outputs), rules=rule_base)


STRAIGHT_KINDS = tuple(kind(shape) for shape in (Triangle, Trapezoid, Rectangle, Ramp, Points))
CURVED_KINDS = tuple(kind(shape) for shape in SHAPES if kind(shape) not in (*STRAIGHT_KINDS, "singleton"))


def _other(random: Generator, variable: Input | Output, term: Term, *, curved: bool) -> Term:
    kinds = CURVED_KINDS if curved and random.random() < 0.5 else STRAIGHT_KINDS
    try:
        found = converted(term.shape, _one(random, kinds))
        validate_shape(found)
    except InvalidSystemError:  # a set without width cannot take every shape
        found = term.shape
    if isinstance(found, Points) and random.random() < 0.5:
        places = sorted(variable.low + (variable.high - variable.low) * random.integers(0, 9, 5) / 8)
        degrees = random.integers(0, 5, 5) / 4
        found = Points(tuple({float(x): (float(x), float(y)) for x, y in zip(places, degrees, strict=True)}.values()))
        if not degrees.any() or not any(y for _, y in found.points):
            found = term.shape
    height = float(_one(random, (1.0, 1.0, 0.5, 0.1 + 0.9 * random.random())))
    return Term(term.name, found, height, bool(random.random() < 0.2))


def system(random: Generator, name: str, *, curved: bool, ordered: bool, **operators) -> FuzzySystem:
    inputs = tuple(
        Input(f"x{i}", *ends, _terms(random, ends, curved=curved), out_of_range="clamp")
        for i, ends in enumerate(_ranges(random, int(random.integers(1, 4))))
    )
    outputs = tuple(
        Output(f"y{i}", *ends, _output_terms(random, ends, curved=curved, ordered=ordered), no_fire=NoFire("nan"))
        for i, ends in enumerate(_ranges(random, int(random.integers(1, 3))))
    )
    table = None
    if len(inputs) > 1 and random.random() < 0.5:
        first, second, output = inputs[0], inputs[1], outputs[0]
        names = [None, *(term.name for term in output.terms)]
        cells = tuple(tuple(names[random.integers(len(names))] for _ in second.terms) for _ in first.terms)
        table = RuleTable(first.name, second.name, output.name, cells)
    rules = tuple(_rule(random, inputs, outputs) for _ in range(random.integers(1, 6)))
    drawn = {
        # The drastic and nilpotent norms jump: rounding decides which side of the jump a degree is on.
        "conjunction": _one(random, ("min", "product", "bounded_difference", "einstein_product", "hamacher_product")),
        "disjunction": _one(random, ("max", "algebraic_sum", "bounded_sum", "einstein_sum", "hamacher_sum")),
        "implication": _one(random, ("min", "product")),
        "aggregation": _one(random, ("max", "sum")),
    }
    return FuzzySystem(name, inputs, outputs, RuleBase(table, rules), Inference(**{**drawn, **operators}))


def inputs_for(random: Generator, system: FuzzySystem) -> list[float]:
    """Return inputs: anywhere, at a vertex of a term, at an end of the range or outside it."""
    values = []
    for variable in system.inputs:
        kind = random.integers(5)
        value = variable.low + random.random() * (variable.high - variable.low)
        if kind == 0:
            shape = variable.terms[random.integers(len(variable.terms))].shape
            points = locations(shape)
            value = float(points[random.integers(len(points))])
        elif kind == 1:
            value = _one(random, (variable.low, variable.high, variable.low - 1.0, variable.high + 1.0))
        elif kind == 2:
            value = variable.low + random.integers(17) / 16 * (variable.high - variable.low)
        values.append(float(value) if math.isfinite(value) else variable.low)
    return values


def _one(random: Generator, choices: Sequence[Any]) -> Any:
    return choices[int(random.integers(len(choices)))]


def _ranges(random: Generator, count: int) -> list[Range]:
    ranges = []
    for _ in range(count):
        if random.random() < 0.5:
            low = float(random.integers(-8, 8))
            ranges.append((low, low + float(random.integers(1, 17))))
        else:
            low = random.normal() * 10.0 ** random.integers(-3, 4)
            ranges.append((low, low + random.random() * 10.0 ** random.integers(-3, 4) + 1e-3))
    return ranges


def _points(random: Generator, ends: Range, count: int) -> list[float]:
    """Return places in and around the range in ascending order; many coincide."""
    low, high = ends
    steps = random.integers(-4, 13, count) / 8 if random.random() < 0.6 else random.uniform(-0.5, 1.5, count)
    points = sorted(float(low + step * (high - low)) for step in steps)
    if random.random() < 0.1:
        points[1] = points[0] + _TOWARDS * (high - low) * random.random()
    return sorted(map(float, points))


def shape(random: Generator, ends: Range, *, curved: bool) -> Shape:
    low, high = ends
    if curved and random.random() < 0.5:
        mean = low + (high - low) * random.uniform(-0.2, 1.2)
        return Gaussian(mean, (high - low) * 10.0 ** random.uniform(-1.5, 0.5))
    a, b, c, d = _points(random, ends, 4)
    opened = random.integers(8)
    a = -math.inf if opened == 0 else a
    d = math.inf if opened == 1 else d
    return Triangle(a, b, d) if random.random() < 0.5 else Trapezoid(a, b, c, d)


def _terms(random: Generator, ends: Range, *, curved: bool) -> tuple[Term, ...]:
    """Return one to four terms, at times the same set twice."""
    shapes = [shape(random, ends, curved=curved) for _ in range(random.integers(1, 5))]
    if random.random() < 0.1:
        shapes.append(shapes[0])
    return tuple(Term(f"t{i}", found) for i, found in enumerate(shapes))


def _output_terms(random: Generator, ends: Range, *, curved: bool, ordered: bool) -> tuple[Term, ...]:
    low, high = ends
    if ordered:
        terms = partition(random, ends)
        return tuple(terms[i] for i in random.permutation(len(terms)))
    terms = _terms(random, ends, curved=curved)
    # An output's set must have an area within the range.
    kept = []
    for term in terms:
        left, right = sets.support(term, low, high)
        has_area = right - left > 2 * MIN_RELATIVE_WIDTH * (high - low)
        kept.append(term if has_area else Term(term.name, Triangle(low, low + (high - low) / 4, high)))
    return tuple(kept)


def partition(random: Generator, ends: Range) -> tuple[Term, ...]:
    """Return sets of which only neighbours overlap, with gaps, plateaus, vertical sides and open ends."""
    low, high = ends
    count = int(random.integers(1, 6))
    width = (high - low) / count
    found = []
    for i in range(count):
        start = low + i * width
        left = start - width * _one(random, (0.0, 0.2, 0.5))
        right = start + width * _one(random, (1.0, 1.0, 1.2, 0.9))
        b = start + width * float(_one(random, (0.25, 0.5, random.uniform(0.2, 0.6))))
        c = max(b, start + width * _one(random, (0.0, 0.75)))
        a = _one(random, (left, left, left, max(left, b)))
        d = _one(random, (right, right, right, c))
        if d - a <= 0:
            a, d = left, right
        found.append(Trapezoid(a, b, c, d))
    if random.random() < 0.3:
        found[0] = Trapezoid(-math.inf, found[0].b, found[0].c, found[0].d)
    if random.random() < 0.3:
        found[-1] = Trapezoid(found[-1].a, found[-1].b, found[-1].c, math.inf)
    return tuple(Term(f"t{i}", shape) for i, shape in enumerate(found))


def _rule(random: Generator, inputs: tuple[Input, ...], outputs: tuple[Output, ...]) -> Rule:
    consequents = {_proposition(random, outputs) for _ in range(random.integers(1, 3))}
    weight = float(_one(random, (1.0, 1.0, 1.0, 0.0, random.random())))
    ordered = tuple(sorted(consequents, key=lambda proposition: (proposition.variable, proposition.term)))
    return Rule(_expression(random, inputs, 3), ordered, weight)


def _expression(random: Generator, inputs: tuple[Input, ...], depth: int) -> Expression:
    kind = random.integers(6)
    if depth == 0 or kind < 3:
        return _proposition(random, inputs)
    if kind == 3:
        return Not(_expression(random, inputs, depth - 1))
    operands = tuple(_expression(random, inputs, depth - 1) for _ in range(random.integers(2, 4)))
    return And(operands) if kind == 4 else Or(operands)


def _proposition(random: Generator, variables: tuple[Input, ...] | tuple[Output, ...]) -> Is:
    variable = variables[random.integers(len(variables))]
    return Is(variable.name, variable.terms[random.integers(len(variable.terms))].name)
