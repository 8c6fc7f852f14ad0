"""What a format can say, and what is written where it cannot: shared by the writers of other engines' formats."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from typing import Any

from msgspec.structs import replace

from fuzzy.compiler.methods import grouping
from fuzzy.errors import InvalidSystemError
from fuzzy.kernels import codes
from fuzzy.shapes import Gaussian2, Rectangle, Shape, Trapezoid, Triangle
from fuzzy.system import (
    WEIGHTED_VALUES,
    And,
    Expression,
    FuzzySystem,
    Hedged,
    Inference,
    Is,
    Not,
    Or,
    Rule,
    RuleBase,
    Variable,
)

_MARK = re.compile(r"[^0-9A-Za-z_]+")


class Adapter:
    """Refuses what a format cannot say, or collects what is written instead.

    Attributes:
        title: The format, for messages.
        lossy: Whether substitutes are written.
        substitutes: What was written instead of what, one phrase each.
    """

    def __init__(self, title: str, *, lossy: bool) -> None:
        self.title = title
        self.lossy = lossy
        self.substitutes: list[str] = []

    def cannot(self, what: str, path: str, instead: str | None = None) -> None:
        """Note a substitute.

        Raises:
            InvalidSystemError: Substitutes are not wanted, or there is none.
        """
        if self.lossy and instead is not None:
            self.substitutes.append(f"{path}: {self.title} cannot say {what}; written is {instead}")
            return
        hint = f"; --lossy writes {instead}" if instead is not None else ""
        raise InvalidSystemError(f"{self.title} cannot say {what}{hint}", path)

    def word(self, table: Mapping[str, str], value: str, path: str, otherwise: str | None) -> str:
        """Return the format's word for an operator.

        Args:
            table: The document's words by the format's.
            value: The document's word.
            path: Place in the document.
            otherwise: The document's word that is written instead; None if there is none.
        """
        for word, meaning in table.items():
            if meaning == value:
                return word
        self.cannot(f"'{value}'", path, None if otherwise is None else f"'{otherwise}'")
        return next(word for word, meaning in table.items() if meaning == otherwise)


def has_weighted_outputs(system: FuzzySystem) -> bool:
    """Return whether a system is Sugeno's or Tsukamoto's."""
    return system.inference.defuzzifier in WEIGHTED_VALUES


def weighted_aggregation(inference: Inference) -> str:
    """Return how a weighted average counts several rules that conclude one term: their "sum", or their "max"."""
    return "max" if grouping(inference) == codes.LARGEST_STRENGTH else "sum"


def digits(value: float) -> str:
    """Return the shortest text from which a number is read again."""
    if math.isinf(value):
        return "inf" if value > 0 else "-inf"
    return str(int(value)) if value.is_integer() and abs(value) < 1e15 else repr(value)


def join(values: Iterable[float], between: str = " ") -> str:
    """Return numbers with something between them."""
    return between.join(digits(float(value)) for value in values)


def bounded(shape: Shape, low: float, high: float) -> Shape:
    """Return a set that is the same within [low, high] and has no infinite parameter.

    Inputs are limited to their range, and an output's sets are cut off there: nothing changes.
    """
    width = high - low
    match shape:
        case Triangle(a=a, b=b, c=c) if math.isinf(a):
            left = min(low, b) - width
            return Trapezoid(left, left, b, c)
        case Triangle(a=a, b=b, c=c) if math.isinf(c):
            right = max(high, b) + width
            return Trapezoid(a, b, right, right)
        case Trapezoid(a=a, b=b, c=c, d=d):
            if math.isinf(a):
                a = b = min(low, b) - width
            if math.isinf(d):
                c = d = max(high, c) + width
            return Trapezoid(a, b, c, d)
        case Rectangle(a=a, b=b):
            a = min(low, b) - width if math.isinf(a) else a
            return Rectangle(a, max(high, a) + width if math.isinf(b) else b)
        case Gaussian2(left_mean=left, right_mean=right):
            if math.isinf(left):
                left = min(low, right) - width
            if math.isinf(right):
                right = max(high, left) + width
            return Gaussian2(left, shape.left_sigma, right, shape.right_sigma)
        case _:
            return shape


def check_inputs(adapter: Adapter, system: FuzzySystem) -> None:
    """Note inputs that refuse values outside their range: other engines take or limit them."""
    for entry in system.inputs:
        if entry.out_of_range == "reject":
            adapter.cannot("out_of_range: reject", f"inputs.{entry.name}.out_of_range", "clamp")


def named(adapter: Adapter, system: FuzzySystem, reserved: frozenset[str]) -> FuzzySystem:
    """Return the system with names that are identifiers: letters, digits and _, no reserved word, no digit first.

    Args:
        adapter: Notes every name that is changed.
        system: A valid system.
        reserved: Words, in lower case, that cannot be names.
    """
    variables = _renamed(adapter, [(entry.name, _path(system, entry)) for entry in _all(system)], reserved)
    terms = {
        entry.name: _renamed(
            adapter, [(term.name, f"{_path(system, entry)}.terms.{term.name}") for term in entry.terms], reserved
        )
        for entry in _all(system)
    }
    title = _identifier(system.name, reserved)
    if title != system.name:
        adapter.cannot(f"the name '{system.name}'", "name", f"'{title}'")
    if title == system.name and all(old == new for names in (variables, *terms.values()) for old, new in names.items()):
        return system
    return _with_names(replace(system, name=title), variables, terms)


def _all(system: FuzzySystem) -> tuple[Variable, ...]:
    return (*system.inputs, *system.outputs)


def _path(system: FuzzySystem, entry: Variable) -> str:
    return f"{'inputs' if entry in system.inputs else 'outputs'}.{entry.name}"


def _identifier(name: str, reserved: frozenset[str]) -> str:
    plain = _MARK.sub("_", name).strip("_") or "x"
    if plain[0].isdigit():
        plain = f"x{plain}"
    if name.isascii() and name.isidentifier() and name[0] != "_" and name.lower() not in reserved:
        return name
    return f"{plain}_" if plain.lower() in reserved else plain


def _renamed(adapter: Adapter, names: list[tuple[str, str]], reserved: frozenset[str]) -> dict[str, str]:
    """Return a new name for each, all different also when their case does not count."""
    used: set[str] = set()
    changed: dict[str, str] = {}
    for name, path in names:
        base = new = _identifier(name, reserved)
        number = 2
        while new.casefold() in used:
            new, number = f"{base}_{number}", number + 1
        used.add(new.casefold())
        if new != name:
            adapter.cannot(f"the name '{name}'", path, f"'{new}'")
        changed[name] = new
    return changed


def _with_names(
    system: FuzzySystem, variables: Mapping[str, str], terms: Mapping[str, Mapping[str, str]]
) -> FuzzySystem:
    def variable(entry: Any) -> Any:
        renamed = tuple(replace(term, name=terms[entry.name][term.name]) for term in entry.terms)
        return replace(entry, name=variables[entry.name], terms=renamed)

    def expression(entry: Expression) -> Expression:
        match entry:
            case Is():
                return proposition(entry)
            case Not(operand=operand):
                return Not(expression(operand))
            case Hedged(operand=operand, hedge=hedge):
                return Hedged(expression(operand), hedge)
            case And(operands=operands):
                return And(tuple(expression(operand) for operand in operands))
            case Or(operands=operands):
                return Or(tuple(expression(operand) for operand in operands))

    def proposition(entry: Is) -> Is:
        return Is(variables[entry.variable], terms[entry.variable][entry.term])

    def rule(entry: Rule) -> Rule:
        return Rule(expression(entry.antecedent), tuple(map(proposition, entry.consequents)), entry.weight)

    table = system.rules.table
    if table is not None:
        cells = tuple(tuple(None if cell is None else terms[table.output][cell] for cell in row) for row in table.cells)
        table = type(table)(variables[table.rows], variables[table.columns], variables[table.output], cells)
    return replace(
        system,
        inputs=tuple(map(variable, system.inputs)),
        outputs=tuple(map(variable, system.outputs)),
        rules=RuleBase(table, tuple(map(rule, system.rules.list))),
    )
