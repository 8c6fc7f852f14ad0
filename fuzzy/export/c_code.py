"""A controller as C99: one .c and one .h file, no heap, no more of the C library than the shapes need."""

from __future__ import annotations

import re
from typing import NamedTuple

from fuzzy.errors import InvalidSystemError
from fuzzy.export import c_table
from fuzzy.export.c_defuzzify import defuzzification
from fuzzy.export.c_functions import (
    HEDGES,
    S_NORMS,
    T_NORMS,
    Shapes,
    constant,
    needs_library,
    one_argument_function,
    two_argument_function,
)
from fuzzy.language import format_rule
from fuzzy.rules import all_rules
from fuzzy.system import And, Expression, FuzzySystem, Hedged, Is, Not, Or
from fuzzy.validation import validate

_WORD = re.compile(r"[^0-9A-Za-z_]+")


class CFiles(NamedTuple):
    """The two files, and what is true of them.

    Attributes:
        source: The .c file.
        header: The .h file.
        bounds: For a lookup table, how far each output is off at most; empty for the exact computation.
    """

    source: str
    header: str
    bounds: tuple[float, ...] = ()


def c_files(system: FuzzySystem, stem: str, *, is_single: bool = False, table: int | None = None) -> CFiles:
    """Return a controller as C99.

    Args:
        system: A valid system.
        stem: Name of the files without suffix; the function is called so, with _evaluate behind.
        is_single: Whether numbers are float; otherwise double.
        table: Points of each input's axis in a lookup table; None for the exact computation.

    Raises:
        InvalidSystemError: For what is not exported, or a table that is too large or not defined everywhere.
    """
    system = validate(system)
    name = _identifier(stem)
    body, bounds = _exact(system) if table is None else c_table.lookup(system, table, is_single=is_single)
    notes = [
        f"largest error of the table: {bound:.3g} in {output.name}"
        for bound, output in zip(bounds, system.outputs, strict=False)
    ]
    return CFiles(_source(system, name, stem, body, notes, is_single), _header(system, name, notes, is_single), bounds)


def _identifier(stem: str) -> str:
    """Return the function's name: no word of C, of its library or of this code ends so."""
    plain = _WORD.sub("_", stem).strip("_")
    return f"{plain if plain and not plain[0].isdigit() else f'fuzzy_{plain}'}_evaluate"


def _comment(text: str) -> str:
    """Return a text that cannot end a C comment, in plain ASCII."""
    return text.replace("*/", "* /").replace("/*", "/ *").encode("ascii", "replace").decode().replace("??", "? ?")


def _header(system: FuzzySystem, name: str, notes: list[str], is_single: bool) -> str:
    real = "float" if is_single else "double"
    guard = f"{name.upper()}_H"
    listed = [f" * x[{i}]  {_about(entry)}" for i, entry in enumerate(system.inputs)]
    listed += [f" * y[{i}]  {_about(entry)}" for i, entry in enumerate(system.outputs)]
    listed += [f" * {_comment(note)}" for note in notes]
    return "\n".join(
        [
            f"/* {_comment(system.name)}: a fuzzy controller.",
            " *",
            *listed,
            " *",
            " * Returns 0; or -1, and leaves y as it is, when an input is not finite. Inputs outside their range count",
            " * as its nearer end. Give y a start value before the first call: outputs that hold keep their last one.",
            " */",
            f"#ifndef {guard}",
            f"#define {guard}",
            "",
            f"int {name}(const {real} x[{len(system.inputs)}], {real} y[{len(system.outputs)}]);",
            "",
            "#endif",
            "",
        ]
    )


def _about(entry: object) -> str:
    text = f"{entry.name} in [{entry.low:g}, {entry.high:g}] {entry.unit}"  # type: ignore[attr-defined]
    return _comment(text.rstrip())


def _source(system: FuzzySystem, name: str, stem: str, body: c_table.Body, notes: list[str], is_single: bool) -> str:
    inputs = "".join(
        f"    REAL x{i} = x[{i}] < {constant(entry.low)} ? {constant(entry.low)} : "
        f"x[{i}] > {constant(entry.high)} ? {constant(entry.high)} : x[{i}];\n"
        for i, entry in enumerate(system.inputs)
    )
    finite = " && ".join(f"x[{i}] - x[{i}] == C(0.0)" for i in range(len(system.inputs)))
    function = (
        f"\nint {name}(const REAL x[{len(system.inputs)}], REAL y[{len(system.outputs)}])\n{{\n"
        f"{inputs}{body.variables}\n"
        f"    if (!({finite}))\n        return -1;\n{body.statements}    return 0;\n}}\n"
    )
    code = body.definitions + function
    head = [f"/* {_comment(system.name)}: a fuzzy controller, written by the fuzzy workbench. */"]
    head += [f"/* {_comment(note)} */" for note in notes]
    head.append(f'#include "{_comment(stem)}.h"')
    if needs_library(code) or "NAN" in code:
        head.append("#include <math.h>")
    head += [
        "",
        f"typedef {'float' if is_single else 'double'} REAL;",
        f"#define C(x) {'x##f' if is_single else '(x)'}",
    ]
    if needs_library(code):
        head.append(f"#define M(name) {'name##f' if is_single else 'name'}")
    if "BIG" in code:
        head.append(f"#define BIG C({'3.4e38' if is_single else '1e300'})")
    return "\n".join(head) + "\n" + code


def _exact(system: FuzzySystem) -> tuple[c_table.Body, tuple[float, ...]]:
    """Return fuzzification, rules and defuzzification."""
    shapes = Shapes()
    places = {
        (entry.name, term.name): f"m{i}_{k}"
        for i, entry in enumerate(system.inputs)
        for k, term in enumerate(entry.terms)
    }
    used: set[str] = set()
    writer = _Expressions(places)
    rules = all_rules(system)
    strengths = []
    for number, rule in enumerate(rules):
        antecedent = writer.text(rule.antecedent)
        weight = "" if rule.weight == 1 else f"{constant(rule.weight)} * "
        strengths.append(f"    /* {_comment(format_rule(rule))} */\n    w[{number}] = {weight}{antecedent};\n")
    used = writer.used
    degrees = "".join(
        f"    REAL {places[entry.name, term.name]} = {shapes.degree(term, f'x{i}')};\n"
        for i, entry in enumerate(system.inputs)
        for term in entry.terms
        if places[entry.name, term.name] in used
    )
    unused = "".join(
        f"    (void)x{i};\n"
        for i, entry in enumerate(system.inputs)
        if not any(places[entry.name, term.name] in used for term in entry.terms)
    )
    code = defuzzification(system, shapes)
    norms = ""
    if writer.uses_and:
        norms += two_argument_function("both", T_NORMS[system.inference.conjunction])
    if writer.uses_or:
        norms += two_argument_function("either", S_NORMS[system.inference.disjunction])
    for hedge in sorted(writer.hedges):
        norms += one_argument_function(f"hedge_{hedge}", HEDGES[hedge])
    levels = "".join(
        f"    REAL level_{number}[{len(output.terms)}];\n"
        for number, output in enumerate(system.outputs)
        if f"level_{number}" in code.statements
    )
    scalars = [word for word in ("area", "moment", "value", "strongest") if re.search(rf"\b{word}\b", code.statements)]
    variables = degrees + f"    REAL w[{max(len(rules), 1)}];\n{levels}"
    if scalars:
        variables += f"    REAL {', '.join(scalars)};\n"
    if re.search(r"\bi\b", code.statements):
        variables += "    int i;\n"
    statements = unused + "".join(strengths) + code.statements
    if not rules:
        statements = "    (void)w;\n" + statements
    return c_table.Body(shapes.definitions() + norms + code.definitions, variables, statements), ()


class _Expressions:
    """Antecedents as C expressions; remembers what they use."""

    def __init__(self, places: dict[tuple[str, str], str]) -> None:
        self._places = places
        self.used: set[str] = set()
        self.hedges: set[str] = set()
        self.uses_and = self.uses_or = False

    def text(self, expression: Expression) -> str:
        match expression:
            case Is(variable=variable, term=term):
                if (variable, term) not in self._places:
                    raise InvalidSystemError(
                        f"C code has no rules that ask for an output, as for '{variable}': "
                        "choose a lookup table (--table N)",
                        "rules",
                    )
                self.used.add(self._places[variable, term])
                return self._places[variable, term]
            case Not(operand=operand):
                return f"(C(1.0) - {self.text(operand)})"
            case Hedged(operand=operand, hedge=hedge):
                self.hedges.add(hedge)
                return f"hedge_{hedge}({self.text(operand)})"
            case And(operands=operands):
                self.uses_and = True
                return self._joined("both", operands)
            case Or(operands=operands):
                self.uses_or = True
                return self._joined("either", operands)

    def _joined(self, function: str, operands: tuple[Expression, ...]) -> str:
        text = self.text(operands[0])
        for operand in operands[1:]:
            text = f"{function}({text}, {self.text(operand)})"
        return text
