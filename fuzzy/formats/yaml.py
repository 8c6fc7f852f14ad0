"""The workbench's own files: YAML, schema ``fuzzy-workbench/1``, as ``rulebases/README.md`` describes it."""

from __future__ import annotations

import typing
from collections.abc import Mapping
from typing import Any

import msgspec

from fuzzy import shapes
from fuzzy import system as document
from fuzzy.errors import FormatError, InvalidSystemError, expected, shown
from fuzzy.formats import yaml_tree
from fuzzy.formats import yaml_values as values
from fuzzy.formats.assembly import Imported
from fuzzy.formats.yaml_tree import Node
from fuzzy.language import parse_rule
from fuzzy.limits import MAX_RULES
from fuzzy.shapes import Shape
from fuzzy.system import (
    SCHEMA,
    FuzzySystem,
    Inference,
    Input,
    NoFire,
    Output,
    Rule,
    RuleBase,
    RuleTable,
    Sampling,
    Term,
)
from fuzzy.validation import validate

OPERATOR_KEYS = {
    "and": "conjunction",
    "or": "disjunction",
    "implication": "implication",
    "aggregation": "aggregation",
    "defuzzifier": "defuzzifier",
}
"""Keys of the file's ``inference`` and the fields of ``Inference`` that they set."""

_POLICIES = typing.get_args(document.NoFirePolicy)
_SHAPES: dict[str, type[Shape]] = {shapes.kind(shape): shape for shape in shapes.KINDS}
_TERM_KEYS = ("height", "complement")


def read(text: str, source: str) -> Imported:
    """Read a file's text.

    Args:
        text: The YAML.
        source: Name of the file, for errors.

    Raises:
        FormatError: With line, column and path of the first mistake, what was found and what is valid.
    """
    root = yaml_tree.parse(text, source)
    found = _sections(root)
    # The variables are checked before the rules, which can then say what their names may be.
    system = _located(_variables(found), root)
    if "rules" in found:
        system = _located(msgspec.structs.replace(system, rules=_rules(found["rules"], system)), root)
    return Imported(system, (), yaml_tree.positions(root))


def _located(system: FuzzySystem, root: Node) -> FuzzySystem:
    """Return the system if it is valid, or raise the error at its place in the file."""
    try:
        return validate(system)
    except InvalidSystemError as error:
        line, column = nearest(yaml_tree.positions(root), error.path)
        raise FormatError(error.message, root.source, line, column, error.path) from None


def nearest(places: Mapping[str, tuple[int, int]], path: str) -> tuple[int, int]:
    """Return the position of ``path``, or of the innermost part of it that stands in the file."""
    while path not in places and path:
        path = path[: max(path.rfind("."), path.rfind("["), 0)]
    return places.get(path, (1, 1))


def _sections(root: Node) -> dict[str, Node]:
    _check_schema(root)
    return values.fields(root, ("schema", "name", "inputs", "outputs"), ("notes", "rules", "inference"))


def _variables(found: dict[str, Node]) -> FuzzySystem:
    """Return the system without its rules."""
    inputs = values.entries(found["inputs"], "inputs by name")
    outputs = values.entries(found["outputs"], "outputs by name")
    return FuzzySystem(
        name=values.text(found["name"], "a name"),
        inputs=tuple(_input(name, node) for name, node in inputs.items()),
        outputs=tuple(_output(name, node) for name, node in outputs.items()),
        inference=_inference(found["inference"]) if "inference" in found else Inference(),
        notes=values.text(found["notes"]) if "notes" in found else "",
    )


def _check_schema(root: Node) -> None:
    """Refuse another schema by its name before anything else is looked at."""
    first = next(iter(values.entries(root, f"a mapping that begins with 'schema: {SCHEMA}'").items()), None)
    if first is None or first[0] != "schema":
        place = root if first is None else first[1]
        raise place.key_error(f"expected 'schema: {SCHEMA}' first")
    node = first[1]
    found = values.text(node, f"'{SCHEMA}'")
    if found == SCHEMA:
        return
    name, _, version = SCHEMA.partition("/")
    found_name, _, found_version = found.partition("/")
    if (
        found_name == name
        and found_version.isdecimal()
        and 0 < len(found_version) < 10
        and int(found_version) > int(version)
    ):
        raise node.error(f"'{found}' is newer than this program, which reads up to {SCHEMA}")
    raise node.error(f"unknown schema '{shown(found)}'; valid: {SCHEMA}")


def _input(name: str, node: Node) -> Input:
    found = values.fields(node, ("range", "terms"), ("unit", "out_of_range"))
    low, high = _range(found["range"])
    policy: Any = "clamp"
    if "out_of_range" in found:
        policy = values.choice(found["out_of_range"], typing.get_args(document.OutOfRange))
    return Input(name, low, high, _terms(found["terms"]), _unit(found), policy)


def _output(name: str, node: Node) -> Output:
    found = values.fields(node, ("range", "terms"), ("unit", "no_fire"))
    low, high = _range(found["range"])
    no_fire = _no_fire(found["no_fire"]) if "no_fire" in found else NoFire()
    return Output(name, low, high, _terms(found["terms"]), _unit(found), no_fire)


def _unit(found: dict[str, Node]) -> str:
    return values.text(found["unit"]) if "unit" in found else ""


def _range(node: Node) -> tuple[float, float]:
    ends = values.items(node, "a range such as [-1, 1]")
    if len(ends) != 2:
        raise node.error(f"expected a range of two numbers such as [-1, 1], found {len(ends)}")
    return values.number(ends[0]), values.number(ends[1])


def _terms(node: Node) -> tuple[Term, ...]:
    return tuple(_term(name, entry) for name, entry in values.entries(node, "terms by name").items())


def _term(name: str, node: Node) -> Term:
    found = values.entries(node, "a shape such as {triangle: [-1, 0, 1]}")
    kinds = {word: entry for word, entry in found.items() if word not in _TERM_KEYS}
    if len(kinds) != 1:
        raise node.error(f"expected one shape such as {{triangle: [-1, 0, 1]}}, found {len(kinds)}")
    ((word, parameters),) = kinds.items()
    if word not in _SHAPES:
        raise parameters.key_error(f"unknown shape {expected(shown(word), (*_SHAPES, *_TERM_KEYS))}")
    height = values.number(found["height"]) if "height" in found else 1.0
    complement = "complement" in found and values.choice(found["complement"], ("true", "false")) == "true"
    return Term(name, _shape(word, parameters), height, complement)


def _shape(word: str, node: Node) -> Shape:
    shape = _SHAPES[word]
    if shape is shapes.Points:
        pairs = values.items(node, "a list of points such as [[-1, 0], [0, 1]]")
        return shapes.Points(tuple(_point(pair) for pair in pairs))
    names = shapes.parameter_names(shape)
    wanted = "a coefficient for each input and a constant" if shape is shapes.Linear else f"{len(names)} numbers"
    numbers = values.items(node, f"a list of {wanted}" + ("" if shape is shapes.Linear else f": {', '.join(names)}"))
    try:
        return shapes.build(word, [values.number(entry, finite=False) for entry in numbers])
    except InvalidSystemError as error:
        raise node.error(error.message) from None


def _point(node: Node) -> tuple[float, float]:
    pair = values.items(node, "a point such as [0.5, 1]")
    if len(pair) != 2:
        raise node.error(f"expected a point of two numbers such as [0.5, 1], found {len(pair)}")
    return values.number(pair[0]), values.number(pair[1])


def _no_fire(node: Node) -> NoFire:
    if isinstance(node.value, dict):
        return NoFire("default", values.number(values.fields(node, ("default",))["default"]))
    words = [policy for policy in _POLICIES if policy != "default"]
    if not isinstance(node.value, str) or node.value not in words:
        found = yaml_tree.describe(node)
        raise node.error(f"expected {{default: VALUE}} or one of {', '.join(words)}, found {found}")
    policy: Any = node.value
    return NoFire(policy)


def _rules(node: Node, system: FuzzySystem) -> RuleBase:
    found = values.fields(node, (), ("table", "list"))
    table = _table(found["table"], system) if "table" in found else None
    listed = values.items(found["list"], "a list of rules") if "list" in found else []
    if len(listed) > MAX_RULES:
        raise found["list"].key_error(f"{len(listed)} rules: at most {MAX_RULES}")
    return RuleBase(table, tuple(_rule(entry, system) for entry in listed))


def _rule(node: Node, system: FuzzySystem) -> Rule:
    written = values.text(node, 'a rule such as "if e is NB then T is LL"')
    try:
        return parse_rule(written, system)
    except FormatError as error:
        raise node.error_inside(error.message, error.column - 1) from None


def _table(node: Node, system: FuzzySystem) -> RuleTable:
    found = values.fields(node, ("rows", "columns", "output", "cells"))
    inputs = {variable.name: variable for variable in system.inputs}
    outputs = {variable.name: variable for variable in system.outputs}
    rows = _named(found["rows"], inputs)
    columns = _named(found["columns"], inputs)
    output = _named(found["output"], outputs)
    if rows == columns:
        raise found["columns"].error(f"rows and columns are the same input '{columns}'")
    row_terms = [term.name for term in inputs[rows].terms]
    column_terms = [term.name for term in inputs[columns].terms]
    terms = [term.name for term in outputs[output].terms]
    cells = values.entries(found["cells"], f"a row of cells for each term of '{rows}'")
    for name, row in cells.items():
        if name not in row_terms:
            raise row.key_error(f"unknown term of '{rows}': {expected(shown(name), row_terms)}")
    for name in row_terms:
        if name not in cells:
            raise found["cells"].key_error(f"the row of the term '{name}' of '{rows}' is missing")
    return RuleTable(
        rows, columns, output, tuple(_row(cells[name], columns, column_terms, output, terms) for name in row_terms)
    )


def _named(node: Node, variables: dict[str, Any]) -> str:
    name = values.text(node, "the name of a variable")
    if name not in variables:
        raise node.error(f"unknown variable {expected(shown(name), variables)}")
    return name


def _row(node: Node, columns: str, column_terms: list[str], output: str, terms: list[str]) -> tuple[str | None, ...]:
    cells = values.items(node, f"a list of {len(column_terms)} terms of '{output}'")
    if len(cells) != len(column_terms):
        count = f"{len(cells)} cells for the {len(column_terms)} terms of '{columns}'"
        raise node.error(f"{count}: {', '.join(column_terms)}")
    return tuple(_cell(cell, output, terms) for cell in cells)


def _cell(node: Node, output: str, terms: list[str]) -> str | None:
    if node.is_null and (node.value not in terms or node.value in {"", "~"}):
        return None
    name = values.text(node, f"a term of '{output}' or ~")
    if name not in terms:
        raise node.error(f"unknown term of '{output}': {expected(shown(name), terms)}; ~ is no rule")
    return name


def _inference(node: Node) -> Inference:
    found = values.fields(node, (), (*OPERATOR_KEYS, "resolution"))
    hints = typing.get_type_hints(Inference)
    chosen: dict[str, Any] = {
        field: values.choice(found[key], typing.get_args(hints[field]))
        for key, field in OPERATOR_KEYS.items()
        if key in found
    }
    if "resolution" in found:
        chosen["resolution"] = _resolution(found["resolution"])
    return Inference(**chosen)


def _resolution(node: Node) -> Any:
    if not isinstance(node.value, dict):
        if node.value == "exact":
            return "exact"
        raise node.error(f"expected exact or {{points: 101, rule: endpoints}}, found {yaml_tree.describe(node)}")
    found = values.fields(node, ("points",), ("rule",))
    points = values.number(found["points"])
    if not points.is_integer():
        raise found["points"].error(f"expected a whole number, found {found['points'].value}")
    if "rule" not in found:
        return Sampling(int(points))
    rule: Any = values.choice(found["rule"], typing.get_args(document.SamplingRule))
    return Sampling(int(points), rule)
