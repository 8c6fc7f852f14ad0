"""The document: a fuzzy system as frozen values that are compared by value, never by identity."""

from __future__ import annotations

from typing import Literal

import msgspec

from fuzzy.shapes import Shape

TNorm = Literal[
    "min",
    "product",
    "bounded_difference",
    "drastic_product",
    "einstein_product",
    "hamacher_product",
    "nilpotent_minimum",
]
SNorm = Literal[
    "max", "algebraic_sum", "bounded_sum", "drastic_sum", "einstein_sum", "hamacher_sum", "nilpotent_maximum"
]
Implication = Literal[
    "min",
    "product",
    "bounded_difference",
    "drastic_product",
    "einstein_product",
    "hamacher_product",
    "nilpotent_minimum",
    "bounded_sum",
    "algebraic_sum",
    "kleene_dienes",
]
Aggregation = Literal[
    "max",
    "sum",
    "algebraic_sum",
    "bounded_sum",
    "drastic_sum",
    "einstein_sum",
    "hamacher_sum",
    "nilpotent_maximum",
    "min",
]
Defuzzifier = Literal[
    "centroid",
    "center_of_sums",
    "bisector",
    "mom",
    "som",
    "lom",
    "som_abs",
    "lom_abs",
    "height",
    "weighted_average",
    "weighted_sum",
]
SamplingRule = Literal["midpoints", "endpoints", "left", "trapezoid", "left_with_break_points", "polygon"]
Hedge = Literal["very", "extremely", "somewhat", "more_or_less", "plus", "intensify", "seldom", "any"]
OutOfRange = Literal["clamp", "reject"]
NoFirePolicy = Literal["default", "hold", "midpoint", "nan"]

WEIGHTED_VALUES: frozenset[Defuzzifier] = frozenset({"weighted_average", "weighted_sum"})
"""Defuzzifiers of Sugeno's and Tsukamoto's systems: weighted values of the terms, no sets."""

SCHEMA = "fuzzy-workbench/1"
"""Name and version of the document's schema, the first line of every file."""


class Term(msgspec.Struct, frozen=True):
    """A linguistic term and its fuzzy set: ``height`` times the shape's degree, or times 1 minus it.

    In a Sugeno system an output's term is a singleton or a linear function of the inputs.
    """

    name: str
    shape: Shape
    height: float = 1.0
    complement: bool = False


class Input(msgspec.Struct, frozen=True):
    """A crisp input: its universe [low, high], its terms, and what happens to a value outside."""

    name: str
    low: float
    high: float
    terms: tuple[Term, ...]
    unit: str = ""
    out_of_range: OutOfRange = "clamp"


class NoFire(msgspec.Struct, frozen=True):
    """What an output is when no rule fires: ``value`` (default), the last output, the midpoint of its range, or NaN.

    The value may lie outside the output's range, as that of IEC 61131-7's DEFAULT.
    """

    policy: NoFirePolicy = "default"
    value: float = 0.0


class Output(msgspec.Struct, frozen=True):
    """A crisp output: its universe [low, high], its terms, and its value when no rule fires."""

    name: str
    low: float
    high: float
    terms: tuple[Term, ...]
    unit: str = ""
    no_fire: NoFire = NoFire()


Variable = Input | Output


class Is(msgspec.Struct, frozen=True, tag="is"):
    """Proposition "``variable`` is ``term``".

    The variable is an input; of an antecedent also an output, whose degree is how far the rules before have activated
    the term.
    """

    variable: str
    term: str


class Not(msgspec.Struct, frozen=True, tag="not"):
    """Complement of an expression: 1 - degree."""

    operand: Expression


class Hedged(msgspec.Struct, frozen=True, tag="hedged"):
    """An expression with a linguistic hedge: a function of its degree, see :mod:`fuzzy.kernels.hedges`."""

    operand: Expression
    hedge: Hedge


class And(msgspec.Struct, frozen=True, tag="and"):
    """Conjunction of two or more expressions by the system's AND."""

    operands: tuple[Expression, ...]


class Or(msgspec.Struct, frozen=True, tag="or"):
    """Disjunction of two or more expressions by the system's OR."""

    operands: tuple[Expression, ...]


Expression = Is | Not | Hedged | And | Or


class Rule(msgspec.Struct, frozen=True):
    """If ``antecedent`` then all of ``consequents``; ``weight`` in [0, 1] multiplies the firing strength."""

    antecedent: Expression
    consequents: tuple[Is, ...]
    weight: float = 1.0


class RuleTable(msgspec.Struct, frozen=True):
    """Rules "if rows is r and columns is c then output is cells[r][c]", one a cell; None is no rule.

    ``cells`` has one row for each term of the input ``rows`` and one column for each term of ``columns``, in the
    order of the terms.
    """

    rows: str
    columns: str
    output: str
    cells: tuple[tuple[str | None, ...], ...]


class RuleBase(msgspec.Struct, frozen=True):
    """The rules: a table for two inputs, and a list for what a table cannot say. Rules are numbered in this order."""

    table: RuleTable | None = None
    list: tuple[Rule, ...] = ()


class Sampling(msgspec.Struct, frozen=True):
    """Defuzzification over samples, as other engines do.

    ``midpoints`` of N intervals; ``endpoints``, N points with both ends; ``left``, the left ends of N intervals;
    ``trapezoid``, N points with both ends, of which these count half; ``left_with_break_points``, the left ends of N
    intervals and all points at which a set of the output bends; ``polygon``, straight lines through N points with both
    ends and through the points where sets that are straight between them are clipped.
    """

    points: int
    rule: SamplingRule = "midpoints"


class Inference(msgspec.Struct, frozen=True):
    """The operators; ``resolution`` is the closed form (exact) or another engine's sampling."""

    conjunction: TNorm = "min"
    disjunction: SNorm = "max"
    implication: Implication = "min"
    aggregation: Aggregation = "max"
    defuzzifier: Defuzzifier = "centroid"
    resolution: Literal["exact"] | Sampling = "exact"


class FuzzySystem(msgspec.Struct, frozen=True):
    """A Mamdani, Sugeno or Tsukamoto system; the defuzzifier tells which.

    Valid ones come from :func:`fuzzy.validation.validate` or from a file.
    """

    name: str
    inputs: tuple[Input, ...]
    outputs: tuple[Output, ...]
    rules: RuleBase = RuleBase()
    inference: Inference = Inference()
    notes: str = ""
