"""C code for any aggregate of straight lines: its centroid, bisector and maxima, by the kernels' own formulas."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fuzzy.compiler import methods
from fuzzy.export.c_exact import side_tables, sides_of
from fuzzy.export.c_functions import constant
from fuzzy.export.c_kernels import translated
from fuzzy.export.c_parts import Code, levels, members, result
from fuzzy.export.kernel_source import bound
from fuzzy.kernels import codes, linear, norms, pieces
from fuzzy.kernels.exact import sort
from fuzzy.system import FuzzySystem

_FOLLOW = """
/* Enters all straight parts of an aggregated set into the account: {question}. */
static void follow_{number}(REAL *account, const REAL *knot, const int *first, const int *term, const REAL (*side)[2],
                     int intervals, REAL origin, const int *member, const REAL *level, int count)
{{
    REAL terms[2 * MOST_MEMBERS], lines[2 * MOST_MEMBERS], places[2 * MOST_MEMBERS + 1], pair[2];
    int i, m, p, b, bends;
    {begin}(account);
    for (i = 0; i < intervals; i++) {{
        REAL left = knot[i], width = knot[i + 1] - knot[i], start = C(0.0);
        bends = 0;
        for (m = 0; m < count; m++) {{
            REAL one = C(0.0), other = C(0.0);
            for (p = first[i]; p < first[i + 1]; p++)
                if (term[p] == member[m]) {{
                    one = side[p][0];
                    other = side[p][1];
                }}
            terms[2 * m] = one;
            terms[2 * m + 1] = other;
            bends = linear_add_bend(one, other, {level}(level[m]), places, bends);
{second}        }}
        exact_sort(places, bends);
        places[bends] = C(1.0);
        for (b = 0; b <= bends; b++) {{
            REAL end = places[b];
            if (end <= start)
                continue;
            for (m = 0; m < count; m++) {{
                REAL slope = terms[2 * m + 1] - terms[2 * m], centre = C(0.5) * (start + end);
                {imply}(C(1.0), level[m], terms[2 * m] + centre * slope, slope, pair);
                lines[2 * m] = pair[0] - (centre - start) * pair[1];
                lines[2 * m + 1] = pair[1];
            }}
            {join}(account, origin, {least}, lines, 2 * count, left, width, start, end);
            start = end;
        }}
    }}
}}
"""

_QUESTIONS = {pieces.AREA: "area and moment", pieces.HALF: "half the area", pieces.TOP: "where it is largest"}


def lines(system: FuzzySystem) -> Code:
    """Return the code for a system whose implied sets, and their aggregates, consist of straight pieces."""
    inference = system.inference
    implication = methods.IMPLICATION[inference.implication]
    fixed = {
        "imply": {"code": implication},
        "bend_level": {"code": implication},
        "join": {"code": methods.AGGREGATION[methods.aggregation(inference)]},
        "top": {"which": methods.MAXIMUM.get(inference.defuzzifier, codes.MEAN)},
    }
    questions, value, condition = _asked(system)
    asked = [(question, {**fixed, "": {"question": question}}) for question in questions]
    kernels: list[Callable[..., Any]] = [
        linear.add_bend,
        norms.bend_level,
        sort,
        linear.imply,
        linear.join,
        pieces.begin,
    ]
    if questions == [pieces.TOP]:
        kernels.append(pieces.top)
    code = translated((kernel, bindings) for _, bindings in asked for kernel in kernels)
    second = "            bends = linear_add_bend(one, other, level[m], places, bends);\n"
    code += "".join(
        _FOLLOW.format(
            question=_QUESTIONS[question],
            number=question,
            begin=bound(pieces.begin, bindings).name,
            level=bound(norms.bend_level, bindings).name,
            imply=bound(linear.imply, bindings).name,
            join=bound(linear.join, bindings).name,
            second=second if implication == norms.NILPOTENT_MINIMUM else "",
            least=constant(0.0 if implication <= norms.PRODUCT else norms.ROUNDING),
        )
        for question, bindings in asked
    )
    definitions, statements = "", f"    REAL account[{pieces.ACCOUNT}];\n"
    most = 1
    for number, (output, found) in enumerate(zip(system.outputs, members(system), strict=True)):
        knots, sides = sides_of(output)
        origin = 0.5 * (output.low + output.high)
        definitions += side_tables(number, knots, sides, 0.0)
        statements += _gathered(number, len(output.terms), found, methods.grouping(inference))
        most = max(most, len(found), len(output.terms))
        call = f"(account, knot_{number}, first_{number}, term_{number}, side_{number}, {len(sides)}, "
        call += f"{constant(origin)}, member, level, count);\n"
        statements += f"    follow_{questions[0]}{call}"
        if len(questions) > 1:
            statements += f"    account[{pieces.TARGET}] = C(0.5) * account[{pieces.SUM}];\n"
            statements += f"    area = account[{pieces.SUM}];\n"
            statements += f"    if (area > C(0.0))\n        follow_{questions[1]}{call}"
        text = value.format(origin=constant(origin), top=bound(pieces.top, fixed).name)
        statements += result(system, number, text, condition)
    head = f"#define MOST_MEMBERS {most}\n"
    statements = f"    REAL level[MOST_MEMBERS];\n    int member[MOST_MEMBERS], count;\n{statements}"
    return Code(head + code + definitions, f"    {{\n{statements}    }}\n")


def _asked(system: FuzzySystem) -> tuple[list[int], str, str]:
    """Return what is asked of the set, one question after the other, the output, and where it is defined."""
    match system.inference.defuzzifier:
        case "centroid" | "center_of_sums":
            value = f"{{origin}} + account[{pieces.MOMENT}] / account[{pieces.SUM}]"
            return [pieces.AREA], value, f"account[{pieces.SUM}] > C(0.0)"
        case "bisector":
            return [pieces.AREA, pieces.HALF], f"account[{pieces.PLACE}]", "area > C(0.0)"
        case _:
            return [pieces.TOP], "{top}(account)", f"account[{pieces.BEST}] > C(0.0)"


def _gathered(number: int, n_terms: int, found: list[tuple[int, int]], grouping: int) -> str:
    """Return the statements that list the members of an output's set with their levels."""
    if grouping == codes.EVERY_CONSEQUENT:
        return "    count = 0;\n" + "".join(
            f"    if (w[{rule}] > C(0.0)) {{\n"
            f"        member[count] = {term};\n        level[count++] = w[{rule}];\n    }}\n"
            for rule, term in found
        )
    gathered = levels(number, n_terms, found, sums=grouping == codes.SUM_OF_STRENGTHS)
    return (
        f"{gathered}    count = 0;\n    for (i = 0; i < {n_terms}; i++)\n"
        f"        if (level_{number}[i] > C(0.0)) {{\n            member[count] = i;\n"
        f"            level[count++] = level_{number}[i];\n        }}\n"
    )
