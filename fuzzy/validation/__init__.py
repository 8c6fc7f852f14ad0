"""What a valid document is. Readers, edits and the compiler rely on it; kernels check nothing."""

from __future__ import annotations

from typing import NamedTuple, TypeVar

import msgspec
import numpy as np

from fuzzy.errors import InvalidSystemError
from fuzzy.identity import ByIdentity
from fuzzy.limits import MAX_NOTES, MAX_POINTS, MAX_RULES, MAX_VARIABLES, MIN_POINTS
from fuzzy.system import FuzzySystem, Inference, Input, Output, Rule, RuleBase, RuleTable, Sampling
from fuzzy.validation.rules import TermNames, check_rule, check_table
from fuzzy.validation.texts import check_count, check_name, check_text, check_unique
from fuzzy.validation.variables import check_output, check_variable

_Struct = TypeVar("_Struct", bound=msgspec.Struct)


class _Frame(NamedTuple):
    """The parts of a valid document on which its rules depend, and the rules that were found valid with them."""

    inputs: tuple[Input, ...]
    outputs: tuple[Output, ...]
    inference: Inference
    input_terms: TermNames
    output_terms: TermNames
    rules: ByIdentity[Rule]  # as given and as returned -> as returned


_VALID: ByIdentity[_Frame] = ByIdentity(32)
"""What was found valid, by inputs, outputs and operators: an edit of a rule leaves all but that rule as they are."""


def validate(system: FuzzySystem) -> FuzzySystem:
    """Refuse a document that breaks a rule of the schema or of fuzzy inference.

    Args:
        system: A document from anywhere; its fields may hold wrong types.

    Returns:
        The document, its numbers as floats and its sequences as tuples.

    Raises:
        InvalidSystemError: With the path of the first mistake, what was found and what is valid.
    """
    found = _in_known_frame(system)
    if found is not None:
        return found
    given = system
    system = _typed(system)
    _check_texts(system)
    frame = _checked_frame(system)
    _check_table_and_count(system.rules, frame)
    for index, rule in enumerate(system.rules.list):
        check_rule(rule, frame.input_terms, frame.output_terms, f"rules.list[{index}]")
    _VALID.put(frame, system.inputs, system.outputs, system.inference)
    # An equal one has only such parts as cannot change, too; others have to be converted every time.
    if (given.inputs, given.outputs, given.inference) == (system.inputs, system.outputs, system.inference):
        _VALID.put(frame, given.inputs, given.outputs, given.inference)
    for before, rule in zip(given.rules.list, system.rules.list, strict=True):
        _keep(before, rule, frame)
    return system


def _in_known_frame(system: FuzzySystem) -> FuzzySystem | None:
    """Return the document if its variables and operators have been found valid before, and the rest of it is valid.

    None where a closer look must say what is wrong.
    """
    if not (isinstance(system, FuzzySystem) and isinstance(system.rules, RuleBase)):
        return None
    frame = _VALID.get(system.inputs, system.outputs, system.inference)
    if frame is None or not (isinstance(system.name, str) and isinstance(system.notes, str)):
        return None
    table, listed = system.rules.table, system.rules.list
    if not isinstance(listed, tuple):
        return None
    try:
        if table is not None:
            table = _converted(table, RuleTable)
        known = enumerate(zip(listed, frame.rules.get_each(listed), strict=True))
        rules = tuple([valid or _new_rule(rule, frame, index) for index, (rule, valid) in known])
    except (msgspec.ValidationError, RecursionError, TypeError, ValueError, OverflowError):
        return None
    found = FuzzySystem(system.name, frame.inputs, frame.outputs, RuleBase(table, rules), frame.inference, system.notes)
    _check_texts(found)
    _check_table_and_count(found.rules, frame)
    return found


def _new_rule(given: Rule, frame: _Frame, index: int) -> Rule:
    rule = _converted(given, Rule)
    check_rule(rule, frame.input_terms, frame.output_terms, f"rules.list[{index}]")
    _keep(given, rule, frame)
    return rule


def _keep(given: Rule, rule: Rule, frame: _Frame) -> None:
    frame.rules.put(rule, rule)
    if given == rule:
        frame.rules.put(rule, given)


def _check_texts(system: FuzzySystem) -> None:
    check_name(system.name, "name", "the system's name")
    check_text(system.notes, "notes", MAX_NOTES)


def _checked_frame(system: FuzzySystem) -> _Frame:
    """Check everything but texts and rules."""
    check_count(system.inputs, "inputs", "inputs", MAX_VARIABLES)
    check_count(system.outputs, "outputs", "outputs", MAX_VARIABLES)
    check_unique(
        [(entry.name, f"inputs.{entry.name}") for entry in system.inputs]
        + [(entry.name, f"outputs.{entry.name}") for entry in system.outputs]
    )
    for entry in system.inputs:
        check_variable(entry, f"inputs.{entry.name}")
    for entry in system.outputs:
        check_output(entry, f"outputs.{entry.name}", system.inference.defuzzifier, len(system.inputs))
    resolution = system.inference.resolution
    if isinstance(resolution, Sampling) and not MIN_POINTS <= resolution.points <= MAX_POINTS:
        message = f"{resolution.points} points: valid are {MIN_POINTS} to {MAX_POINTS}"
        raise InvalidSystemError(message, "inference.resolution.points")
    return _Frame(
        system.inputs,
        system.outputs,
        system.inference,
        {entry.name: [term.name for term in entry.terms] for entry in system.inputs},
        {entry.name: [term.name for term in entry.terms] for entry in system.outputs},
        ByIdentity(2 * MAX_RULES),
    )


def _check_table_and_count(rules: RuleBase, frame: _Frame) -> None:
    count = len(rules.list)
    if rules.table is not None:
        count += check_table(rules.table, frame.input_terms, frame.output_terms)
    if count > MAX_RULES:
        raise InvalidSystemError(f"{count} rules: at most {MAX_RULES}", "rules")


def _typed(system: FuzzySystem) -> FuzzySystem:
    """Check the types of all fields: constructors do not, and a document may have been built by hand."""
    if not isinstance(system, FuzzySystem):
        raise InvalidSystemError(f"expected a FuzzySystem, found {type(system).__name__}")
    try:
        return _converted(system, FuzzySystem)
    except msgspec.ValidationError as error:
        message, _, place = str(error).partition(" - at `$")
        raise InvalidSystemError(message, place.strip("`.")) from None
    except (RecursionError, TypeError, ValueError, OverflowError) as error:
        raise InvalidSystemError(f"the document holds what the schema does not: {error}") from None


def _converted(value: object, kind: type[_Struct]) -> _Struct:
    """Return a part of a document with the types of the schema, or raise what msgspec raises."""
    return msgspec.convert(msgspec.to_builtins(value, enc_hook=_plain), kind)


def _plain(value: object) -> object:
    """Return NumPy's scalars as Python's, which the schema knows."""
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"{type(value).__name__}")
