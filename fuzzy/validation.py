"""What a valid document is. Readers, edits and the compiler rely on it; kernels check nothing."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

import msgspec
import numpy as np
from msgspec.structs import replace

from fuzzy import rules, sets, shapes
from fuzzy.errors import InvalidSystemError, expected
from fuzzy.invariants import validate_shape
from fuzzy.shapes import Linear, Points
from fuzzy.system import (
    And,
    Defuzzifier,
    Expression,
    FuzzySystem,
    Hedged,
    Inference,
    Input,
    Is,
    Not,
    Or,
    Output,
    Rule,
    RuleBase,
    RuleTable,
    Sampling,
    Variable,
)

MAX_VARIABLES = 16
"""Greatest number of inputs, and of outputs."""

MAX_TERMS = 64
"""Greatest number of terms of an input."""

MAX_OUTPUT_TERMS = 256
"""Greatest number of terms of an output: a Sugeno system has one for each rule."""

MAX_RULES = 4096
"""Greatest number of rules, table and list together."""

MAX_NAME = 64
"""Greatest length of a name or a unit, in characters."""

MAX_NOTES = 20_000
"""Greatest length of the notes, in characters."""

MAX_VALUE = 1e12
"""Greatest magnitude of a range's end or a shape's parameter: squares and differences keep their digits."""

MIN_RELATIVE_WIDTH = 1e-9
"""Least width of a range over its magnitude, and of an output term's set over its range."""

MIN_WIDTH = 1e-12
"""Least width of a range."""

MIN_POINTS, MAX_POINTS = 2, 100_000
"""Numbers of samples that a sampled defuzzifier may take."""


def validate(system: FuzzySystem) -> FuzzySystem:
    """Refuse a document that breaks a rule of the schema or of fuzzy inference.

    Args:
        system: A document from anywhere; its fields may hold wrong types.

    Returns:
        The document, its numbers as floats and its sequences as tuples.

    Raises:
        InvalidSystemError: With the path of the first mistake, what was found and what is valid.
    """
    if _has_valid_parts(system):
        return _with_valid_table(system)
    system = _typed(system)
    _check_texts(system)
    _check_count(system.inputs, "inputs", "inputs", MAX_VARIABLES)
    _check_count(system.outputs, "outputs", "outputs", MAX_VARIABLES)
    _check_unique(
        [(entry.name, f"inputs.{entry.name}") for entry in system.inputs]
        + [(entry.name, f"outputs.{entry.name}") for entry in system.outputs]
    )
    for entry in system.inputs:
        _check_variable(entry, f"inputs.{entry.name}")
    for entry in system.outputs:
        _check_output(entry, f"outputs.{entry.name}", system.inference.defuzzifier, len(system.inputs))
    _check_rules(system)
    resolution = system.inference.resolution
    if isinstance(resolution, Sampling) and not MIN_POINTS <= resolution.points <= MAX_POINTS:
        message = f"{resolution.points} points: valid are {MIN_POINTS} to {MAX_POINTS}"
        raise InvalidSystemError(message, "inference.resolution.points")
    parts = _parts(system)
    _VALID_PARTS[tuple(map(id, parts))] = parts
    while len(_VALID_PARTS) > _KEPT:
        _VALID_PARTS.pop(next(iter(_VALID_PARTS)), None)
    return system


_Parts = tuple[tuple[Input, ...], tuple[Output, ...], tuple[Rule, ...], Inference]

_KEPT = 32

_VALID_PARTS: dict[tuple[int, ...], _Parts] = {}
"""What was found valid together, by identity: these objects cannot change, and as long as they are kept here no others
have their identities. Painting a cell leaves all of them as they are."""


def _parts(system: FuzzySystem) -> _Parts:
    return system.inputs, system.outputs, system.rules.list, system.inference


def _has_valid_parts(system: FuzzySystem) -> bool:
    """Return whether all but the names, notes and the table of a system have been found valid before."""
    if not (isinstance(system, FuzzySystem) and isinstance(system.rules, RuleBase)):
        return False
    return tuple(map(id, _parts(system))) in _VALID_PARTS


def _with_valid_table(system: FuzzySystem) -> FuzzySystem:
    """Return a system with valid parts if its name, notes and table are valid, too."""
    for path, text in (("name", system.name), ("notes", system.notes)):
        if not isinstance(text, str):
            raise InvalidSystemError(f"Expected `str`, got `{type(text).__name__}`", path)
    _check_texts(system)
    table = system.rules.table
    if table is not None:
        try:
            table = msgspec.convert(msgspec.to_builtins(table, enc_hook=_plain), RuleTable)
        except msgspec.ValidationError as error:
            message, _, place = str(error).partition(" - at `$")
            raise InvalidSystemError(message, f"rules.table{place.strip('`')}") from None
        except (RecursionError, TypeError, ValueError, OverflowError) as error:
            raise InvalidSystemError(f"the table holds what the schema does not: {error}", "rules.table") from None
    found = replace(system, rules=RuleBase(table, system.rules.list))
    _check_table_and_count(found)
    return found


def _check_texts(system: FuzzySystem) -> None:
    _check_name(system.name, "name", "the system's name")
    _check_text(system.notes, "notes", MAX_NOTES)


def _typed(system: FuzzySystem) -> FuzzySystem:
    """Check the types of all fields: constructors do not, and a document may have been built by hand."""
    if not isinstance(system, FuzzySystem):
        raise InvalidSystemError(f"expected a FuzzySystem, found {type(system).__name__}")
    try:
        return msgspec.convert(msgspec.to_builtins(system, enc_hook=_plain), FuzzySystem)
    except msgspec.ValidationError as error:
        message, _, place = str(error).partition(" - at `$")
        raise InvalidSystemError(message, place.strip("`.")) from None
    except (RecursionError, TypeError, ValueError, OverflowError) as error:
        raise InvalidSystemError(f"the document holds what the schema does not: {error}") from None


def _plain(value: object) -> object:
    """Return NumPy's scalars as Python's, which the schema knows."""
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"{type(value).__name__}")


def _check_count(entries: Sequence[object], what: str, path: str, most: int) -> None:
    if not 1 <= len(entries) <= most:
        raise InvalidSystemError(f"{len(entries)} {what}: valid are 1 to {most}", path)


def _check_name(name: str, path: str, what: str) -> None:
    if not name:
        raise InvalidSystemError(f"{what} is empty", path)
    if len(name) > MAX_NAME:
        raise InvalidSystemError(f"{what} has {len(name)} characters: at most {MAX_NAME}", path)
    if not name.isprintable():
        raise InvalidSystemError(f"{what} {name!r} holds a character that cannot be printed", path)
    if name != name.strip():
        raise InvalidSystemError(f"{what} '{name}' begins or ends with a blank", path)


def _check_text(text: str, path: str, most: int) -> None:
    if len(text) > most:
        raise InvalidSystemError(f"{len(text)} characters: at most {most}", path)
    wrong = next((letter for letter in text if not (letter.isprintable() or letter in "\n\t")), None)
    if wrong is not None:
        raise InvalidSystemError(f"holds the character {wrong!r}, which cannot be printed", path)


def _check_unique(names: Iterable[tuple[str, str]]) -> None:
    """Refuse a name that is used twice, at the path of its second use."""
    seen: set[str] = set()
    for name, path in names:
        if name in seen:
            raise InvalidSystemError(f"the name '{name}' is used twice", path)
        seen.add(name)


def _check_variable(variable: Variable, path: str) -> None:
    _check_name(variable.name, path, "a variable's name")
    low, high = variable.low, variable.high
    if not (low < high and max(abs(low), abs(high)) <= MAX_VALUE):
        message = f"[{low:g}, {high:g}]: valid is low < high, both finite and at most {MAX_VALUE:g}"
        raise InvalidSystemError(message, f"{path}.range")
    if high - low < max(MIN_WIDTH, MIN_RELATIVE_WIDTH * max(abs(low), abs(high))):
        raise InvalidSystemError(f"[{low!r}, {high!r}] is too narrow to compute with", f"{path}.range")
    if len(variable.unit) > MAX_NAME or not variable.unit.isprintable():
        raise InvalidSystemError(f"expected at most {MAX_NAME} printable characters", f"{path}.unit")
    most = MAX_OUTPUT_TERMS if isinstance(variable, Output) else MAX_TERMS
    _check_count(variable.terms, "terms", f"{path}.terms", most)
    _check_unique([(term.name, f"{path}.terms.{term.name}") for term in variable.terms])
    for term in variable.terms:
        place = f"{path}.terms.{term.name}"
        _check_name(term.name, place, "a term's name")
        validate_shape(term.shape, place)
        if isinstance(term.shape, Linear) and not isinstance(variable, Output):
            raise InvalidSystemError("a linear function is no set: only an output of a Sugeno system has such", place)
        if any(math.isfinite(value) and abs(value) > MAX_VALUE for value in shapes.parameters(term.shape)):
            raise InvalidSystemError(f"a parameter is beyond {MAX_VALUE:g}", place)
        if not 0 < term.height <= 1:
            raise InvalidSystemError(f"height {term.height:g}: valid is greater than 0 and at most 1", place)
        if isinstance(term.shape, Points) and not any(degree > 0 for _, degree in term.shape.points):
            raise InvalidSystemError("all points have the degree 0: no rule with this term could fire", place)


def _check_output(output: Output, path: str, defuzzifier: Defuzzifier, n_inputs: int) -> None:
    _check_variable(output, path)
    for term in output.terms:
        place = f"{path}.terms.{term.name}"
        if isinstance(term.shape, Linear) and len(term.shape.coefficients) != n_inputs:
            message = f"{len(term.shape.coefficients)} coefficients: valid are {n_inputs}, one for each input"
            raise InvalidSystemError(message, place)
    match defuzzifier:
        case "weighted_average" | "weighted_sum":
            _check_values(output, path, defuzzifier)
        case "height":
            _check_peaks(output, path)
        case _:
            _check_areas(output, path, defuzzifier)
    policy, value = output.no_fire.policy, output.no_fire.value
    if policy == "default" and not abs(value) <= MAX_VALUE:
        message = f"default {value:g}: valid is a finite number of at most {MAX_VALUE:g}, also outside the range"
        raise InvalidSystemError(message, f"{path}.no_fire")
    if policy != "default" and value != 0:
        raise InvalidSystemError(
            f"value {value:g} belongs to the policy 'default', not to '{policy}'", f"{path}.no_fire"
        )


def _check_values(output: Output, path: str, defuzzifier: str) -> None:
    """Refuse terms that do not say by themselves, or by how far they are activated, what the output is."""
    for term in output.terms:
        if isinstance(term.shape, Linear) or sets.is_singleton(term):
            continue
        if not sets.is_monotone(term, output.low, output.high):
            message = (
                f"{shapes.kind(term.shape)} has no single value for {defuzzifier}: valid are singleton and linear "
                "(Sugeno), and sets that rise or fall all over the range (Tsukamoto)"
            )
            raise InvalidSystemError(message, f"{path}.terms.{term.name}")


def _check_peaks(output: Output, path: str) -> None:
    for term in output.terms:
        if isinstance(term.shape, Linear):
            message = "a linear function is no set: valid defuzzifiers are weighted_average and weighted_sum"
            raise InvalidSystemError(message, f"{path}.terms.{term.name}")
        left, right = sets.support(term, output.low, output.high)
        if left > right:
            message = f"the set is 0 in [{output.low:g}, {output.high:g}], so it has no peak there"
            raise InvalidSystemError(message, f"{path}.terms.{term.name}")


def _check_areas(output: Output, path: str, defuzzifier: str) -> None:
    """Refuse sets outside the range, and outputs of which no set has an area, but for one that has singletons only.

    One point among wider sets is legal: it counts where a sample hits it, and nowhere else.
    """
    if all(map(sets.is_singleton, output.terms)):
        if defuzzifier not in {"centroid", "center_of_sums"}:
            valid = "centroid, center_of_sums, height, weighted_average, weighted_sum"
            message = f"singletons have no area for {defuzzifier}: valid are {valid}"
            raise InvalidSystemError(message, f"{path}.terms")
        for term in output.terms:
            place = sets.break_points(term)[0]
            if not output.low <= place <= output.high:
                message = f"{place:g} is outside the range [{output.low:g}, {output.high:g}]"
                raise InvalidSystemError(message, f"{path}.terms.{term.name}")
        return
    least = MIN_RELATIVE_WIDTH * (output.high - output.low)
    has_area = any(
        right - left >= least for left, right in (sets.support(term, output.low, output.high) for term in output.terms)
    )
    for term in output.terms:
        if isinstance(term.shape, Linear):
            message = "a linear function is no set: valid defuzzifiers are weighted_average and weighted_sum"
            raise InvalidSystemError(message, f"{path}.terms.{term.name}")
        left, right = sets.support(term, output.low, output.high)
        is_point = left == right and has_area
        if right - left < least and not is_point:
            message = f"the set has no area in [{output.low:g}, {output.high:g}], so it has no {defuzzifier} there"
            raise InvalidSystemError(message, f"{path}.terms.{term.name}")


def _check_rules(system: FuzzySystem) -> None:
    inputs, outputs = _check_table_and_count(system)
    for index, rule in enumerate(system.rules.list):
        _check_rule(rule, inputs, outputs, f"rules.list[{index}]")


def _check_table_and_count(system: FuzzySystem) -> tuple[dict[str, list[str]], dict[str, list[str]]]:
    """Check the table and how many rules there are; return the terms' names of all inputs and of all outputs."""
    inputs = {entry.name: [term.name for term in entry.terms] for entry in system.inputs}
    outputs = {entry.name: [term.name for term in entry.terms] for entry in system.outputs}
    table = system.rules.table
    count = len(system.rules.list)
    if table is not None:
        _check_table(table, inputs, outputs)
        count += sum(cell is not None for row in table.cells for cell in row)
    if count > MAX_RULES:
        raise InvalidSystemError(f"{count} rules: at most {MAX_RULES}", "rules")
    return inputs, outputs


def _check_table(table: RuleTable, inputs: Mapping[str, list[str]], outputs: Mapping[str, list[str]]) -> None:
    for axis, name, valid in (
        ("rows", table.rows, inputs),
        ("columns", table.columns, inputs),
        ("output", table.output, outputs),
    ):
        if name not in valid:
            raise InvalidSystemError(f"unknown variable {expected(name, valid)}", f"rules.table.{axis}")
    if table.rows == table.columns:
        raise InvalidSystemError(f"rows and columns are the same input '{table.rows}'", "rules.table.columns")
    rows, columns, terms = inputs[table.rows], inputs[table.columns], outputs[table.output]
    if len(table.cells) != len(rows):
        message = f"{len(table.cells)} rows: '{table.rows}' has {len(rows)} terms"
        raise InvalidSystemError(message, "rules.table.cells")
    for row, cells in zip(rows, table.cells, strict=True):
        if len(cells) != len(columns):
            message = f"{len(cells)} cells: '{table.columns}' has {len(columns)} terms: {', '.join(columns)}"
            raise InvalidSystemError(message, f"rules.table.cells.{row}")
        for index, cell in enumerate(cells):
            if cell is not None and cell not in terms:
                message = f"unknown term of '{table.output}': {expected(cell, terms)}"
                raise InvalidSystemError(message, f"rules.table.cells.{row}[{index}]")


def _check_rule(rule: Rule, inputs: Mapping[str, list[str]], outputs: Mapping[str, list[str]], path: str) -> None:
    if not 0 <= rule.weight <= 1:
        raise InvalidSystemError(f"weight {rule.weight:g}: valid is 0 to 1", path)
    _check_expression(rule.antecedent, path, 0)
    found = rules.propositions(rule.antecedent)
    if len(found) > rules.MAX_PROPOSITIONS:
        message = f"{len(found)} propositions in the antecedent: at most {rules.MAX_PROPOSITIONS}"
        raise InvalidSystemError(message, path)
    _check_count(rule.consequents, "consequents", path, rules.MAX_PROPOSITIONS)
    for proposition in found:
        is_output = proposition.variable in outputs
        _check_proposition(proposition, outputs if is_output else inputs, "output" if is_output else "input", path)
    for consequent in rule.consequents:
        _check_proposition(consequent, outputs, "output", path)
    if len(set(rule.consequents)) != len(rule.consequents):
        raise InvalidSystemError("the same consequent stands twice in the rule", path)


def _check_expression(expression: Expression, path: str, depth: int) -> None:
    if depth > rules.MAX_DEPTH:
        raise InvalidSystemError(f"the antecedent is nested more than {rules.MAX_DEPTH} deep", path)
    match expression:
        case Is():
            pass
        case Not(operand=operand) | Hedged(operand=operand):
            _check_expression(operand, path, depth + 1)
        case And(operands=operands) | Or(operands=operands):
            if len(operands) < 2:
                raise InvalidSystemError(f"AND and OR join at least two expressions, found {len(operands)}", path)
            for operand in operands:
                _check_expression(operand, path, depth + 1)


def _check_proposition(proposition: Is, variables: Mapping[str, list[str]], kind: str, path: str) -> None:
    terms = variables.get(proposition.variable)
    if terms is None:
        raise InvalidSystemError(f"unknown {kind} {expected(proposition.variable, variables)}", path)
    if proposition.term not in terms:
        message = f"unknown term of '{proposition.variable}': {expected(proposition.term, terms)}"
        raise InvalidSystemError(message, path)
