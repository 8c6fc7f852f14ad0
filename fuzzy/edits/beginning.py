"""Systems to begin with: evenly spaced terms, and a table without a rule."""

from __future__ import annotations

from fuzzy.edits.spacing import SCHEMES, even_shapes
from fuzzy.errors import InvalidSystemError
from fuzzy.system import FuzzySystem, Input, Output, RuleBase, RuleTable, Term
from fuzzy.validation import validate


def empty_table(terms: int, name: str = "untitled") -> FuzzySystem:
    """Return a controller T(e, de) with evenly spaced triangles and no rule.

    Names and ranges are those of the rule bases that come with the program.

    Args:
        terms: How many each variable has.
        name: The system's name.

    Raises:
        InvalidSystemError: There are no usual names for so many terms.
    """
    if terms not in SCHEMES:
        raise InvalidSystemError(f"{terms} terms: valid are {', '.join(map(str, SCHEMES))}")
    e, de, output = Input("e", -1.0, 1.0, ()), Input("de", -6.0, 6.0, ()), Output("T", -85.0, 85.0, ())
    inputs = tuple(Input(one.name, one.low, one.high, _terms(one, terms)) for one in (e, de))
    outputs = (Output(output.name, output.low, output.high, _terms(output, terms)),)
    table = RuleTable(e.name, de.name, output.name, ((None,) * terms,) * terms)
    return validate(FuzzySystem(name, inputs, outputs, RuleBase(table)))


def _terms(variable: Input | Output, count: int) -> tuple[Term, ...]:
    return tuple(map(Term, SCHEMES[count], even_shapes(variable, count)))
