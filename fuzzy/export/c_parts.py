"""What the C code of every defuzzifier consists of: conclusions, strengths of terms, and the result."""

from __future__ import annotations

from typing import NamedTuple

from fuzzy import sets
from fuzzy.compiler import methods
from fuzzy.export.c_functions import constant
from fuzzy.rules import all_rules
from fuzzy.system import FuzzySystem


class Code(NamedTuple):
    """Definitions that stand before the function, and statements inside it."""

    definitions: str
    statements: str


def members(system: FuzzySystem) -> list[list[tuple[int, int]]]:
    """Return, for each output, the rule and the term of every conclusion."""
    numbers = {output.name: [term.name for term in output.terms] for output in system.outputs}
    return [
        [
            (rule, numbers[output.name].index(consequent.term))
            for rule, entry in enumerate(all_rules(system))
            for consequent in entry.consequents
            if consequent.variable == output.name
        ]
        for output in system.outputs
    ]


def result(system: FuzzySystem, number: int, value: str, condition: str) -> str:
    """Return the statements that write an output, or its value when no rule fires."""
    output = system.outputs[number]
    low, high = constant(output.low), constant(output.high)
    is_limited = not (system.inference.defuzzifier in methods.SETLESS or all(map(sets.is_singleton, output.terms)))
    lines = [f"    if ({condition}) {{", f"        value = {value};"]
    if is_limited:
        lines.append(f"        y[{number}] = value < {low} ? {low} : value > {high} ? {high} : value;")
    else:
        lines.append(f"        y[{number}] = value;")
    middle = constant(0.5 * (output.low + output.high))
    silent = {
        "default": f" else\n        y[{number}] = {constant(output.no_fire.value)};",
        "midpoint": f" else\n        y[{number}] = {middle};",
        "nan": f" else\n        y[{number}] = (REAL)NAN;",
        "hold": " /* else it holds its last value */",
    }[output.no_fire.policy]
    return "\n".join([*lines, f"    }}{silent}"]) + "\n"


def levels(number: int, n_terms: int, found: list[tuple[int, int]], *, sums: bool = False) -> str:
    """Return the statements that gather the strength of every term."""
    lines = [f"    for (i = 0; i < {n_terms}; i++)", f"        level_{number}[i] = C(0.0);"]
    for rule, term in found:
        level = f"level_{number}[{term}]"
        lines.append(
            f"    {level} += w[{rule}];" if sums else f"    if (w[{rule}] > {level})\n        {level} = w[{rule}];"
        )
    return "\n".join(lines) + "\n"
