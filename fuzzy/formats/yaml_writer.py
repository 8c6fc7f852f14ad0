"""A system as YAML: one entry a line and one order of keys, so that a difference between two files shows the edit."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator

from fuzzy import shapes
from fuzzy.formats.yaml import OPERATOR_KEYS
from fuzzy.language import format_rule
from fuzzy.shapes import Points, Shape
from fuzzy.system import SCHEMA, FuzzySystem, Inference, Input, Output, RuleTable, Sampling, Term, Variable

_PLAIN = re.compile(r"[^\W\d][\w./+*-]*( [\w./+*-]+)*")
_MISREAD = frozenset({"y", "n", "yes", "no", "on", "off", "true", "false", "null", "nan", "inf"})
"""Words that a reader of YAML 1.1 or 1.2 takes for something else than a text."""


def write(system: FuzzySystem) -> str:
    """Return the text of a valid system; reading it gives an equal one."""
    return "\n".join(_lines(system)) + "\n"


def _lines(system: FuzzySystem) -> Iterator[str]:
    yield f"schema: {SCHEMA}"
    yield f"name: {scalar(system.name)}"
    yield from _notes(system.notes)
    yield "inputs:"
    for entry in system.inputs:
        yield from _input(entry)
    yield "outputs:"
    for entry in system.outputs:
        yield from _output(entry)
    if system.rules.table is not None or system.rules.list:
        yield "rules:"
    if system.rules.table is not None:
        yield from _table(system.rules.table, system)
    if system.rules.list:
        yield "  list:"
        for rule in system.rules.list:
            yield f"    - {_quoted(format_rule(rule))}"
    yield from _inference(system.inference)


def number(value: float) -> str:
    """Return the shortest text from which a number is read again, by readers of YAML 1.1 too."""
    if math.isinf(value):
        return ".inf" if value > 0 else "-.inf"
    if value.is_integer() and abs(value) < 1e15:
        return str(int(value))
    mantissa, exponent_mark, exponent = repr(value).partition("e")
    return f"{mantissa}.0e{exponent}" if exponent_mark and "." not in mantissa else repr(value)


def scalar(text: str) -> str:
    """Return a one-line text, in quotes only where a reader could take it for something else."""
    if _PLAIN.fullmatch(text) and text.lower() not in _MISREAD:
        return text
    return json.dumps(text, ensure_ascii=False)


def _quoted(text: str) -> str:
    """Return a rule in the quotes that need no escapes for it where there are such."""
    return "'" + text.replace("'", "''") + "'" if '"' in text or "\\" in text else f'"{text}"'


def _notes(notes: str) -> Iterator[str]:
    if not notes:
        return
    lines = notes.removesuffix("\n").split("\n")
    if not notes.endswith("\n") and len(lines) == 1:
        yield f"notes: {scalar(notes)}"
    elif lines[0][:1].strip() and lines[-1] and all(line.rstrip() == line and line.isprintable() for line in lines):
        yield "notes: |" if notes.endswith("\n") else "notes: |-"
        yield from (f"  {line}" if line else "" for line in lines)
    else:
        yield f"notes: {json.dumps(notes, ensure_ascii=False)}"


def _variable(variable: Variable) -> Iterator[str]:
    yield f"  {scalar(variable.name)}:"
    yield f"    range: [{number(variable.low)}, {number(variable.high)}]"
    if variable.unit:
        yield f"    unit: {scalar(variable.unit)}"


def _terms(terms: tuple[Term, ...]) -> Iterator[str]:
    yield "    terms:"
    width = max(len(scalar(term.name)) for term in terms)
    for term in terms:
        label = f"{scalar(term.name)}:"
        yield f"      {label:{width + 1}} {{{shapes.kind(term.shape)}: [{_parameters(term.shape)}]{_others(term)}}}"


def _parameters(shape: Shape) -> str:
    if isinstance(shape, Points):
        return ", ".join(f"[{number(x)}, {number(degree)}]" for x, degree in shape.points)
    return ", ".join(number(value) for value in shapes.parameters(shape))


def _others(term: Term) -> str:
    height = f", height: {number(term.height)}" if term.height != 1 else ""
    return height + (", complement: true" if term.complement else "")


def _input(entry: Input) -> Iterator[str]:
    yield from _variable(entry)
    if entry.out_of_range != "clamp":
        yield f"    out_of_range: {entry.out_of_range}"
    yield from _terms(entry.terms)


def _output(entry: Output) -> Iterator[str]:
    yield from _variable(entry)
    policy = entry.no_fire.policy
    yield f"    no_fire: {f'{{default: {number(entry.no_fire.value)}}}' if policy == 'default' else policy}"
    yield from _terms(entry.terms)


def _table(table: RuleTable, system: FuzzySystem) -> Iterator[str]:
    terms = {variable.name: [scalar(term.name) for term in variable.terms] for variable in _variables(system)}
    rows, columns = terms[table.rows], terms[table.columns]
    label = max(len(row) for row in rows)
    width = max(len(name) for name in (*columns, *terms[table.output]))
    yield "  table:"
    yield f"    rows: {scalar(table.rows)}"
    yield f"    columns: {scalar(table.columns)}"
    yield f"    output: {scalar(table.output)}"
    yield "    cells:"
    yield f"      #{'':{label + 2}}" + "  ".join(f"{column:{width}}" for column in columns).rstrip()
    for row, cells in zip(rows, table.cells, strict=True):
        written = ["~" if cell is None else scalar(cell) for cell in cells]
        padded = "".join(f"{cell + ',':{width + 2}}" for cell in written[:-1]) + written[-1]
        yield f"      {f'{row}:':{label + 1}} [{padded}]"


def _variables(system: FuzzySystem) -> tuple[Variable, ...]:
    return (*system.inputs, *system.outputs)


def _inference(inference: Inference) -> Iterator[str]:
    yield "inference:"
    for key, field in OPERATOR_KEYS.items():
        yield f"  {key}: {getattr(inference, field)}"
    match inference.resolution:
        case Sampling(points=points, rule=rule):
            yield f"  resolution: {{points: {points}, rule: {rule}}}"
        case exact:
            yield f"  resolution: {exact}"
