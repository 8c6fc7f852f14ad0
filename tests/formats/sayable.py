"""Hypothesis strategies for systems that a format can mostly say: its operators, all shapes, its kind of rules."""

from __future__ import annotations

import math
from typing import Any

from hypothesis import strategies as st

from fuzzy import sets
from fuzzy.formats.detection import Format
from fuzzy.formats.fcl import writer as fcl
from fuzzy.formats.fis import words as fis
from fuzzy.formats.fll import words as fll
from fuzzy.formats.fml import words as fml
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
from fuzzy.system import (
    And,
    Expression,
    FuzzySystem,
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
    Sampling,
    Term,
)

OPERATORS: dict[Format, tuple[dict[str, str], ...]] = {
    "fis": (fis.CONJUNCTIONS, fis.DISJUNCTIONS, fis.IMPLICATIONS, fis.AGGREGATIONS, fis.DEFUZZIFIERS),
    "fll": (fll.CONJUNCTIONS, fll.DISJUNCTIONS, fll.CONJUNCTIONS, fll.AGGREGATIONS, fll.DEFUZZIFIERS),
    "fcl": (fcl.CONJUNCTIONS, fcl.DISJUNCTIONS, fcl.ACTIVATIONS, fcl.ACCUMULATIONS, fcl.METHODS),
    "fml": (fml.CONJUNCTIONS, fml.DISJUNCTIONS, fml.CONJUNCTIONS, fml.DISJUNCTIONS, fml.DEFUZZIFIERS),
}
"""AND, OR, implication, aggregation and defuzzifier of each format."""

HEDGES: dict[Format, tuple[str, ...]] = {
    "fis": ("somewhat", "very", "extremely"),
    "fll": tuple(fll.HEDGES.values()),
    "fcl": (),
    "fml": tuple(fml.HEDGES.values()),
}
POLICIES: dict[Format, tuple[str, ...]] = {
    "fis": ("midpoint",),
    "fll": ("default", "hold", "midpoint", "nan"),
    "fcl": ("default", "hold", "midpoint", "nan"),
    "fml": ("default", "midpoint"),
}

_unit = st.integers(0, 16).map(lambda step: step / 16) | st.floats(0, 1)
_wide = st.integers(-4, 20).map(lambda step: step / 16) | st.floats(-0.5, 1.5)
_width = st.floats(0.05, 1)


@st.composite
def shapes(draw: st.DrawFn, low: float, high: float) -> Shape:
    """Any shape near [low, high]."""
    span = high - low

    def places(count: int) -> list[float]:
        return sorted(low + span * draw(_wide) for _ in range(count))

    def width() -> float:
        return span * draw(_width)

    def slope() -> float:
        return draw(st.sampled_from((-1.0, 1.0))) * draw(st.floats(1, 30)) / span

    word = draw(st.integers(0, 17))
    a, b, c, d = places(4)
    is_apart = b - a > 1e-3 * span
    side = draw(st.sampled_from(("none", "left", "right")))
    left, right = (-math.inf if side == "left" else a), (math.inf if side == "right" else d)
    table: list[Shape] = [
        Triangle(left, b, right),
        Trapezoid(left, b, c, right),
        Rectangle(left, right),
        Ramp(a, b) if is_apart else Singleton(a),
        Ramp(b, a) if is_apart else Singleton(a),
        Singleton(b),
        Points(tuple((place, draw(_unit)) for place in sorted({a, b, c, d}))),
        Gaussian(b, width()),
        Gaussian2(-math.inf if side == "left" else b, width(), math.inf if side == "right" else c, width()),
        Bell(b, width(), draw(st.floats(0.5, 4))),
        Sigmoid(b, slope()),
        SigmoidDifference(b, slope(), c, slope()),
        SigmoidProduct(b, slope(), c, slope()),
        SShape(a, b),
        ZShape(c, d),
        PiShape(a, b, c, d),
        Cosine(b, width()),
        Spike(b, width()),
        Concave(a, b) if is_apart else Singleton(a),
    ]
    return table[word]


@st.composite
def _terms(draw: st.DrawFn, low: float, high: float, kind: Format, *, is_output: bool) -> tuple[Term, ...]:
    found = []
    for name in draw(st.sampled_from((("a", "b"), ("low", "mid", "high"), ("n",)))):
        term = Term(name, draw(shapes(low, high)))
        if kind in ("fll", "fcl") and draw(st.integers(0, 4)) == 0:
            term = Term(name, term.shape, height=draw(st.floats(0.2, 1)))
        if kind == "fml" and not is_output and draw(st.integers(0, 4)) == 0:
            term = Term(name, term.shape, complement=True)
        if is_output:
            left, right = sets.support(term, low, high)
            if right - left < 0.05 * (high - low):
                term = Term(name, Triangle(low, 0.5 * (low + high), high))
        found.append(term)
    return tuple(found)


@st.composite
def _propositions(draw: st.DrawFn, variable: Input, kind: Format) -> Expression:
    found: Expression = Is(variable.name, draw(st.sampled_from(variable.terms)).name)
    hedges: Any = HEDGES[kind]
    is_hedged = bool(hedges) and draw(st.integers(0, 3)) == 0
    if is_hedged:
        found = Hedged(found, draw(st.sampled_from(hedges)))
    if draw(st.integers(0, 3)) == 0 and not (is_hedged and kind == "fml"):
        found = Not(found)
    return found


@st.composite
def _antecedents(draw: st.DrawFn, inputs: tuple[Input, ...], kind: Format) -> Expression:
    used = draw(st.lists(st.sampled_from(inputs), min_size=1, max_size=len(inputs), unique_by=lambda entry: entry.name))
    operands = tuple(draw(_propositions(entry, kind)) for entry in used)
    if len(operands) == 1:
        return operands[0]
    found = And(operands) if draw(st.booleans()) else Or(operands)
    if kind in ("fll", "fcl") and draw(st.booleans()):
        found = Or((draw(_propositions(inputs[0], kind)), found))
    if kind == "fcl" and draw(st.booleans()):
        return Not(found)
    return found


@st.composite
def sayable(draw: st.DrawFn, kind: Format) -> FuzzySystem:
    """A system in the words of one format, without weighted averages."""
    ends = st.tuples(st.floats(-100, 100), st.floats(0.5, 200)).map(lambda drawn: (drawn[0], drawn[0] + drawn[1]))
    inputs = tuple(
        Input(name, span[0], span[1], draw(_terms(*span, kind, is_output=False)))
        for name, span in ((name, draw(ends)) for name in draw(st.sampled_from((("x",), ("e", "de"), ("u", "v", "w")))))
    )
    outputs = []
    for name in draw(st.sampled_from((("y",), ("y", "z")))):
        low, high = draw(ends)
        policy: Any = draw(st.sampled_from(POLICIES[kind]))
        value = low + (high - low) * draw(_wide) if policy == "default" else 0.0
        outputs.append(
            Output(name, low, high, draw(_terms(low, high, kind, is_output=True)), no_fire=NoFire(policy, value))
        )
    rules = []
    for _ in range(draw(st.integers(1, 4))):
        concluded = draw(st.lists(st.sampled_from(outputs), min_size=1, max_size=2, unique_by=lambda entry: entry.name))
        consequents = tuple(Is(entry.name, draw(st.sampled_from(entry.terms)).name) for entry in concluded)
        rules.append(Rule(draw(_antecedents(inputs, kind)), consequents, draw(st.just(1.0) | _unit)))
    operators: list[Any] = [draw(st.sampled_from(sorted(set(table.values())))) for table in OPERATORS[kind]]
    if operators[4].startswith("weighted"):
        operators[4] = "centroid"
    resolution: Any = draw(st.sampled_from(("exact", Sampling(101, "endpoints"), Sampling(64), Sampling(50, "left"))))
    inference = Inference(*operators[:5], resolution=resolution)
    return FuzzySystem("system", inputs, tuple(outputs), RuleBase(None, tuple(rules)), inference)
