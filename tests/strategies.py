"""Hypothesis strategies for valid fuzzy systems, tame enough to compute with and odd enough to break a file format."""

from __future__ import annotations

import math
import typing

from hypothesis import strategies as st

from fuzzy import sets
from fuzzy import system as document
from fuzzy.conversion import converted
from fuzzy.errors import InvalidSystemError
from fuzzy.shapes import SHAPES, Gaussian, Shape, Trapezoid, Triangle, kind, parameters
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
    RuleTable,
    Sampling,
    Term,
    Variable,
)
from fuzzy.validation.shapes import validate_shape
from tests import plain

ODD_NAMES = (
    *(
        "NO",
        "y",
        "on",
        "Yes",
        "null",
        "~",
        "true",
        "1e3",
        "0o17",
        "1:30",
        "1_000",
        ".inf",
        "-.inf",
        ".nan",
        "nan",
        "<<",
    ),
    *(
        "=",
        "if",
        "AND",
        "Then",
        "with",
        "is",
        "not",
        "very big",
        "a: b",
        "a #b",
        "#",
        "- a",
        "?",
        "|",
        ">",
        "'",
        "it's",
    ),
    *(
        'say "hi"',
        '"',
        '""',
        "\\",
        "\\n",
        "[x]",
        "{a: b}",
        "a,b",
        "(",
        ")",
        "*x",
        "&x",
        "!t",
        "%",
        "@",
        "`",
        "a.b",
        "x[0]",
    ),
    *("ė", "θ̇", "é", "日本", "😀", "2026-11-22", "0x1F", "-1", "exact", "hold", "default"),
)

_SIMPLE_NAMES = ("e", "de", "x", "y", "z", "u", "v", "w", "NB", "NM", "NS", "Z", "PS", "PM", "PB", "LL", "ML", "SL")

simple_names = st.sampled_from(_SIMPLE_NAMES)
"""Names as in the usual rule bases."""

_printable = st.text(st.characters(exclude_categories=("C", "Z"), codec="utf-8"), min_size=1, max_size=64)

names = st.one_of(simple_names, st.sampled_from(ODD_NAMES), _printable.filter(str.isprintable))
"""All names that are valid."""


_near = st.one_of(st.floats(-0.5, 1.5), st.integers(-4, 12).map(lambda step: step / 8))
_four_near = st.tuples(_near, _near, _near, _near)
_unit = st.floats(0, 1)
_sigma = st.floats(0.02, 1)
_kinds = st.sampled_from(("triangle", "trapezoid", "gaussian"))
_linear_kinds = st.sampled_from(("triangle", "trapezoid"))
_open_sides = st.sampled_from(("none", "none", "left", "right", "both"))


@st.composite
def shapes_on(
    draw: st.DrawFn, low: float, high: float, *, needs_area: bool = False, has_gaussians: bool = True
) -> Shape:
    """A shape near [low, high]; with ``needs_area`` one whose set has an area there, as an output's must."""
    width = high - low
    wanted = draw(_kinds if has_gaussians else _linear_kinds)
    shape: Shape
    if wanted == "gaussian":
        return Gaussian(low + width * draw(_unit), width * draw(_sigma))
    first, second, third, last = (low + width * position for position in sorted(draw(_four_near)))
    side = draw(_open_sides)
    if side in {"left", "both"}:
        first = -math.inf
    if side == "right" or (side == "both" and wanted == "trapezoid"):
        last = math.inf
    shape = Triangle(first, second, last) if wanted == "triangle" else Trapezoid(first, second, third, last)
    left, right = sets.support(plain.term(shape), low, high)
    if needs_area and right - left < 0.01 * width:
        return Triangle(low, low + width / 2, high)
    return shape


_lows = st.one_of(st.integers(-100, 100).map(float), st.floats(-1e3, 1e3))
_widths = st.one_of(st.integers(1, 200).map(float), st.floats(0.01, 1e3))

ranges = st.tuples(_lows, _widths).map(lambda drawn: (drawn[0], drawn[0] + drawn[1]))
"""The ends of a universe."""


@st.composite
def _terms(
    draw: st.DrawFn, ends: tuple[float, float], most: int, needs_area: bool, name, has_gaussians: bool, is_varied: bool
):
    found = draw(st.lists(name, min_size=1, max_size=most, unique=True))
    shape = shapes_on(*ends, needs_area=needs_area, has_gaussians=has_gaussians)
    terms = (Term(term, draw(shape)) for term in found)
    return tuple(draw(_varied(term, ends, needs_area)) if is_varied else term for term in terms)


@st.composite
def _varied(draw: st.DrawFn, term: Term, ends: tuple[float, float], needs_area: bool) -> Term:
    """The term with a set of any kind, with a height, or as a complement."""
    try:
        shape = converted(term.shape, draw(st.sampled_from([kind(each) for each in SHAPES])))
        validate_shape(shape)
        if any(math.isfinite(value) and abs(value) > 1e9 for value in parameters(shape)):
            shape = term.shape
    except InvalidSystemError:  # a set without width cannot take every shape
        shape = term.shape
    other = Term(term.name, shape, draw(st.sampled_from((1.0, 0.5, 0.1))), draw(st.booleans()))
    left, right = sets.support(other, *ends)
    has_area = right - left > 0.01 * (ends[1] - ends[0]) and not sets.is_singleton(other)
    return other if has_area or not needs_area else term


_policies = st.sampled_from(typing.get_args(document.NoFirePolicy))


@st.composite
def no_fires(draw: st.DrawFn, ends: tuple[float, float]) -> NoFire:
    """What an output with these ends may be when no rule fires."""
    policy = draw(_policies)
    low, high = ends
    inside = min(high, low + (high - low) * draw(_unit))
    return NoFire(policy, draw(st.just(inside) | st.floats(-1e12, 1e12)) if policy == "default" else 0.0)


@st.composite
def propositions(draw: st.DrawFn, variables: tuple[Variable, ...]) -> Is:
    """A proposition over one of the variables."""
    variable = draw(st.sampled_from(variables))
    return Is(variable.name, draw(st.sampled_from(variable.terms)).name)


def expressions(variables: tuple[Variable, ...], *, has_hedges: bool = False) -> st.SearchStrategy[Expression]:
    """Antecedents with NOT, AND and OR, and perhaps hedges, in any nesting."""

    def nested(inner: st.SearchStrategy[Expression]) -> st.SearchStrategy[Expression]:
        operands = st.lists(inner, min_size=2, max_size=3).map(tuple)
        hedged = [st.builds(Hedged, inner, st.sampled_from(typing.get_args(document.Hedge)))] if has_hedges else []
        return st.one_of(st.builds(Not, inner), st.builds(And, operands), st.builds(Or, operands), *hedged)

    return st.recursive(propositions(variables), nested, max_leaves=6)


@st.composite
def rules_of(
    draw: st.DrawFn, inputs: tuple[Input, ...], outputs: tuple[Output, ...], *, is_varied: bool = False
) -> Rule:
    """A rule over these variables; one that is varied has hedges and names outputs in its antecedent, too."""
    consequents = draw(st.lists(propositions(outputs), min_size=1, max_size=2, unique=True))
    weight = draw(st.one_of(st.just(1.0), st.floats(0, 1)))
    named: tuple[Variable, ...] = (*inputs, *outputs) if is_varied else inputs
    return Rule(draw(expressions(named, has_hedges=is_varied)), tuple(consequents), weight)


@st.composite
def tables_of(draw: st.DrawFn, inputs: tuple[Input, ...], outputs: tuple[Output, ...]) -> RuleTable:
    """A rule table over two of the inputs, some cells empty."""
    rows, columns = draw(st.permutations(inputs))[:2]
    output = draw(st.sampled_from(outputs))
    cell = st.sampled_from([None, *(term.name for term in output.terms)])
    cells = tuple(tuple(draw(cell) for _ in columns.terms) for _ in rows.terms)
    return RuleTable(rows.name, columns.name, output.name, cells)


_HINTS = typing.get_type_hints(Inference)
_OPERATORS = {field: st.sampled_from(typing.get_args(_HINTS[field])) for field in ("conjunction", "disjunction")} | {
    "implication": st.sampled_from(("min", "product")),
    "aggregation": st.sampled_from(("max", "sum")),
    "defuzzifier": st.sampled_from(("centroid", "center_of_sums")),
}
_ALL_OPERATORS = _OPERATORS | {
    "implication": st.sampled_from(typing.get_args(document.Implication)),
    "aggregation": st.sampled_from(typing.get_args(document.Aggregation)),
    "defuzzifier": st.sampled_from(
        ("centroid", "center_of_sums", "bisector", "mom", "som", "lom", "som_abs", "lom_abs")
    ),
}
"""Operators for every system whose sets have areas."""

_samplings = st.builds(Sampling, st.integers(2, 400), st.sampled_from(typing.get_args(document.SamplingRule)))
_resolutions = {True: st.just("exact"), False: _samplings, None: st.just("exact") | _samplings}


def inferences(*, is_exact: bool | None = None, is_varied: bool = False) -> st.SearchStrategy[Inference]:
    """Operators, all of them if ``is_varied``, and a resolution; ``is_exact`` fixes which kind."""
    return st.builds(Inference, **(_ALL_OPERATORS if is_varied else _OPERATORS), resolution=_resolutions[is_exact])


_notes = st.one_of(st.just(""), st.text(st.sampled_from("ab:#-'\"\\|> \n\t"), max_size=40))
_units = st.sampled_from(("", "rad", "NO", "m/s²"))
_out_of_range = st.sampled_from(typing.get_args(document.OutOfRange))


@st.composite
def systems(
    draw: st.DrawFn,
    *,
    max_inputs: int = 3,
    max_outputs: int = 2,
    max_terms: int = 4,
    max_rules: int = 4,
    name: st.SearchStrategy[str] = simple_names,
    has_gaussians: bool = True,
    is_exact: bool | None = None,
    is_varied: bool = False,
) -> FuzzySystem:
    """A valid system; ``name=names`` for every odd name, ``is_varied`` for all shapes, operators and hedges."""
    count = draw(st.integers(1, max_inputs))
    variables = draw(st.lists(name, min_size=count + 1, max_size=count + max_outputs, unique=True))
    inputs: list[Input] = []
    outputs: list[Output] = []
    for variable in variables[:count]:
        ends = draw(ranges)
        terms = draw(_terms(ends, max_terms, False, name, has_gaussians, is_varied))
        inputs.append(Input(variable, *ends, terms, draw(_units), draw(_out_of_range)))
    for variable in variables[count:]:
        ends = draw(ranges)
        terms = draw(_terms(ends, max_terms, True, name, has_gaussians, is_varied))
        outputs.append(Output(variable, *ends, terms, draw(_units), draw(no_fires(ends))))
    table = draw(st.none() | tables_of(tuple(inputs), tuple(outputs))) if count > 1 else None
    listed = draw(st.lists(rules_of(tuple(inputs), tuple(outputs), is_varied=is_varied), max_size=max_rules))
    inference = draw(inferences(is_exact=is_exact, is_varied=is_varied))
    rule_base = RuleBase(table, tuple(listed))
    return FuzzySystem(draw(name), tuple(inputs), tuple(outputs), rule_base, inference, draw(_notes))
