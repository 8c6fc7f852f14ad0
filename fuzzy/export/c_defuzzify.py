"""C code from firing strengths to crisp outputs: exact for piecewise-linear sets, weighted averages, or samples."""

from __future__ import annotations

from typing import NamedTuple

from fuzzy import geometry, sets
from fuzzy.compiler import methods
from fuzzy.compiler.outputs import compile_outputs
from fuzzy.errors import InvalidSystemError
from fuzzy.export.c_functions import S_NORMS, T_NORMS, Shapes, constant, two_argument_function
from fuzzy.kernels import codes
from fuzzy.rules import all_rules
from fuzzy.shapes import Linear
from fuzzy.system import FuzzySystem, Sampling

_ENVELOPE = """
/* Adds area and moment of the envelope of the sets in one interval, between the points where it may bend. */
static void envelope(REAL left, REAL right, const REAL *at_left, const REAL *at_right, const REAL *level, int count,
                     REAL *area, REAL *moment)
{
    REAL cut[MOST_CUTS], first, second, width;
    int cuts = 2, i, j, k;
    cut[0] = C(0.0);
    cut[1] = C(1.0);
    for (i = 0; i < count; i++)
        for (j = 0; j < count; j++)
            for (k = 0; k < 2; k++) {
                /* side i meets the level j (k = 0), or side j (k = 1) */
                REAL base = k ? STEEP(at_left, level, j) : CAP(level, j);
                REAL end = k ? STEEP(at_right, level, j) : CAP(level, j);
                REAL below = STEEP(at_left, level, i) - base, above = STEEP(at_right, level, i) - end;
                if ((k && j >= i) || (below > C(0.0)) == (above > C(0.0)) || below - above == C(0.0))
                    continue;
                cut[cuts] = below / (below - above);
                if (cut[cuts] > C(0.0) && cut[cuts] < C(1.0))
                    cuts++;
            }
    for (i = 1; i < cuts; i++) { /* sort */
        REAL value = cut[i];
        for (j = i; j > 0 && cut[j - 1] > value; j--)
            cut[j] = cut[j - 1];
        cut[j] = value;
    }
    for (i = 0; i + 1 < cuts; i++) {
        first = second = C(0.0);
        for (k = 0; k < count; k++) {
            REAL cap = CAP(level, k), start = STEEP(at_left, level, k), end = STEEP(at_right, level, k);
            REAL a = start + cut[i] * (end - start), b = start + cut[i + 1] * (end - start);
            a = a < cap ? a : cap;
            b = b < cap ? b : cap;
            first = a > first ? a : first;
            second = b > second ? b : second;
        }
        width = (cut[i + 1] - cut[i]) * (right - left);
        add_part(left + cut[i] * (right - left), width, first, second, area, moment);
    }
}
"""

_PART = """
/* Adds area and moment of a straight part. */
static void add_part(REAL left, REAL width, REAL first, REAL second, REAL *area, REAL *moment)
{
    *area += C(0.5) * width * (first + second);
    *moment += width * (C(0.5) * left * (first + second) + width * (first + C(2.0) * second) / C(6.0));
}
"""

_CLIPPED = """
/* Adds area and moment of one straight side, clipped at a level. */
static void clipped(REAL left, REAL right, REAL first, REAL second, REAL level, REAL *area, REAL *moment)
{
    REAL middle;
    if (first > level && second > level) {
        first = second = level;
    } else if (first > level || second > level) {
        middle = left + (right - left) * (level - first) / (second - first);
        add_part(left, middle - left, first < level ? first : level, level, area, moment);
        left = middle;
        first = level;
        second = second < level ? second : level;
    }
    add_part(left, right - left, first, second, area, moment);
}
"""


class Code(NamedTuple):
    """Definitions that stand before the function, and statements inside it."""

    definitions: str
    statements: str


def defuzzification(system: FuzzySystem, shapes: Shapes) -> Code:
    """Return the code for all outputs, which reads ``w[]``, the firing strengths, and writes ``y[]``.

    Raises:
        InvalidSystemError: For a method that is not exported.
    """
    inference = system.inference
    pointwise = [all(map(sets.is_singleton, output.terms)) for output in system.outputs]
    if inference.defuzzifier in methods.SETLESS or all(pointwise):
        return _weighted(system)
    if any(pointwise):
        raise _refused("sets beside singletons", "outputs")
    if inference.defuzzifier not in ("centroid", "center_of_sums"):
        raise _refused(f"the defuzzifier '{inference.defuzzifier}'", "inference.defuzzifier")
    if isinstance(inference.resolution, Sampling):
        if inference.resolution.rule == "polygon":
            raise _refused("centroid of a polygon", "inference.resolution.rule")
        return _sampled(system, shapes)
    if not all(sets.is_linear(term) for output in system.outputs for term in output.terms):
        raise _refused("an exact centroid of curved sets", "inference.resolution")
    if inference.implication not in ("min", "product"):
        raise _refused(f"an exact centroid under the implication '{inference.implication}'", "inference.implication")
    joined = methods.aggregation(inference)
    if joined not in ("max", "sum"):
        raise _refused(f"an exact centroid under the aggregation '{joined}'", "inference.aggregation")
    return _exact(system)


def _refused(what: str, path: str) -> InvalidSystemError:
    return InvalidSystemError(f"C code has no {what}: choose a sampled resolution, or a lookup table (--table N)", path)


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


def _result(system: FuzzySystem, number: int, value: str, condition: str) -> str:
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


def _weighted(system: FuzzySystem) -> Code:
    """Return weighted averages and sums of constants and linear functions."""
    inference = system.inference
    statements = ""
    for number, (output, found) in enumerate(zip(system.outputs, members(system), strict=True)):
        values = _term_values(system, number)
        statements += "    area = moment = C(0.0);\n"
        if methods.grouping(inference) == codes.LARGEST_STRENGTH:
            for term in range(len(output.terms)):
                rules = [rule for rule, other in found if other == term]
                if rules:
                    statements += "    strongest = C(0.0);\n"
                    statements += "".join(
                        f"    strongest = w[{rule}] > strongest ? w[{rule}] : strongest;\n" for rule in rules
                    )
                    statements += f"    area += strongest;\n    moment += strongest * {values[term]};\n"
        else:
            statements += "".join(
                f"    area += w[{rule}];\n    moment += w[{rule}] * {values[term]};\n" for rule, term in found
            )
        value = "moment" if inference.defuzzifier == "weighted_sum" else "moment / area"
        statements += _result(system, number, value, "area > C(0.0)")
    return Code("", statements)


def _term_values(system: FuzzySystem, number: int) -> list[str]:
    """Return what each term says the output is, as an expression."""
    output = system.outputs[number]
    tables, _ = compile_outputs(system.outputs, system.inference)
    first = int(tables.term_start[number])
    values = []
    for place, term in enumerate(output.terms):
        if isinstance(term.shape, Linear):
            products = (
                f" + {constant(factor)} * x{i}" for i, factor in enumerate(term.shape.coefficients) if factor != 0
            )
            values.append(f"({constant(term.shape.constant)}{''.join(products)})")
            continue
        peak = float(tables.peak[first + place])
        if peak != peak:
            raise _refused("Tsukamoto's inference", f"outputs.{output.name}.terms.{term.name}")
        values.append(constant(peak))
    return values


def _sampled(system: FuzzySystem, shapes: Shapes) -> Code:
    """Return sums over the samples, place by place."""
    inference = system.inference
    if inference.implication not in T_NORMS:
        raise _refused(f"the implication '{inference.implication}'", "inference.implication")
    joined = methods.aggregation(inference)
    if joined not in S_NORMS:
        raise _refused(f"the aggregation '{joined}'", "inference.aggregation")
    tables, _ = compile_outputs(system.outputs, inference)
    definitions = two_argument_function("implied", T_NORMS[inference.implication])
    definitions += two_argument_function("joined", S_NORMS[joined])
    statements = ""
    for number, (output, found) in enumerate(zip(system.outputs, members(system), strict=True)):
        places = tables.sample[tables.sample_start[number] : tables.sample_start[number + 1]]
        listed = ",\n    ".join(f"{{{constant(float(u))}, {constant(float(weight))}}}" for u, weight in places)
        definitions += f"\nstatic const REAL sample_{number}[{len(places)}][2] = {{\n    {listed}}};\n"
        middle = constant(0.5 * (output.low + output.high))
        used = sorted({term for _, term in found})
        statements += "    area = moment = C(0.0);\n"
        statements += f"    for (i = 0; i < {len(places)}; i++) {{\n        REAL u = sample_{number}[i][0];\n"
        for term in used:
            statements += f"        REAL set_{term} = {shapes.degree(output.terms[term], 'u')};\n"
        statements += "        value = C(0.0);\n"
        for rule, term in found:
            statements += f"        if (w[{rule}] > C(0.0))\n"
            statements += f"            value = joined(value, implied(w[{rule}], set_{term}));\n"
        statements += f"        value *= sample_{number}[i][1];\n"
        statements += f"        area += value;\n        moment += value * (u - {middle});\n    }}\n"
        statements += _result(system, number, f"{middle} + moment / area", "area > C(0.0)")
    return Code(definitions, statements)


def _exact(system: FuzzySystem) -> Code:
    """Return areas and moments of straight sides between the points where the sets bend."""
    is_envelope = methods.aggregation(system.inference) == "max"
    is_clipped = system.inference.implication == "min"
    definitions = ""
    statements = ""
    most = 1
    for number, (output, found) in enumerate(zip(system.outputs, members(system), strict=True)):
        segments = [sets.segments(term) for term in output.terms]
        knots = geometry.knots(segments, output.low, output.high)
        middle = 0.5 * (output.low + output.high)
        sides: list[list[tuple[int, float, float]]] = [[] for _ in knots[1:]]
        for term, parts in enumerate(segments):
            for interval, segment in geometry.sides(parts, knots):
                left, right = knots[interval], knots[interval + 1]
                ends = geometry.degree(segment, left), geometry.degree(segment, right)
                if max(ends) > 0:
                    sides[interval].append((term, *ends))
        most = max(most, *(len(interval) for interval in sides))
        definitions += _side_tables(number, knots, sides, middle)
        statements += "    area = moment = C(0.0);\n"
        statements += _levels(number, len(output.terms), found) if is_envelope else ""
        loop = _ENVELOPE_LOOP if is_envelope else _SEPARATE_LOOP if is_clipped else _SCALED_LOOP
        if is_envelope:
            statements += loop.format(n=number, intervals=len(sides))
        elif is_clipped:
            statements += "".join(
                loop.format(n=number, intervals=len(sides), rule=rule, term=term) for rule, term in found
            )
        else:
            statements += _levels(number, len(output.terms), found, sums=True)
            statements += loop.format(n=number, intervals=len(sides))
        statements += _result(system, number, f"{constant(middle)} + moment / area", "area > C(0.0)")
    macros = f"#define MOST_SIDES {most}\n#define MOST_CUTS (2 + 2 * MOST_SIDES * MOST_SIDES)\n"
    if is_clipped:
        macros += "#define STEEP(at, level, k) (at)[k]\n#define CAP(level, k) (level)[k]\n"
    else:
        macros += "#define STEEP(at, level, k) ((level)[k] * (at)[k])\n#define CAP(level, k) (level)[k]\n"
    code = _PART + (_ENVELOPE if is_envelope else _CLIPPED if is_clipped else "")
    return Code(macros + code + definitions, statements)


_ENVELOPE_LOOP = """    for (i = 0; i < {intervals}; i++) {{
        REAL at_left[MOST_SIDES], at_right[MOST_SIDES], level[MOST_SIDES];
        int count = 0, k;
        for (k = first_{n}[i]; k < first_{n}[i + 1]; k++)
            if (level_{n}[term_{n}[k]] > C(0.0)) {{
                at_left[count] = side_{n}[k][0];
                at_right[count] = side_{n}[k][1];
                level[count++] = level_{n}[term_{n}[k]];
            }}
        if (count > 0)
            envelope(knot_{n}[i], knot_{n}[i + 1], at_left, at_right, level, count, &area, &moment);
    }}
"""

_SEPARATE_LOOP = """    if (w[{rule}] > C(0.0))
        for (i = 0; i < {intervals}; i++) {{
            int k;
            for (k = first_{n}[i]; k < first_{n}[i + 1]; k++)
                if (term_{n}[k] == {term})
                    clipped(knot_{n}[i], knot_{n}[i + 1], side_{n}[k][0], side_{n}[k][1], w[{rule}], &area, &moment);
        }}
"""

_SCALED_LOOP = """    for (i = 0; i < {intervals}; i++) {{
        int k;
        for (k = first_{n}[i]; k < first_{n}[i + 1]; k++) {{
            value = level_{n}[term_{n}[k]];
            add_part(knot_{n}[i], knot_{n}[i + 1] - knot_{n}[i], value * side_{n}[k][0], value * side_{n}[k][1],
                          &area, &moment);
        }}
    }}
"""


def _side_tables(number: int, knots: list[float], sides: list[list[tuple[int, float, float]]], middle: float) -> str:
    """Return the tables of one output; places count from the middle of its range."""
    flat = [side for interval in sides for side in interval] or [(0, 0.0, 0.0)]
    first = [sum(len(interval) for interval in sides[:place]) for place in range(len(sides) + 1)]
    listed = ", ".join(constant(knot - middle) for knot in knots)
    degrees = ", ".join(f"{{{constant(left)}, {constant(right)}}}" for _, left, right in flat)
    return (
        f"\nstatic const REAL knot_{number}[{len(knots)}] = {{{listed}}};\n"
        f"static const int first_{number}[{len(first)}] = {{{', '.join(map(str, first))}}};\n"
        f"static const int term_{number}[{len(flat)}] = {{{', '.join(str(term) for term, _, _ in flat)}}};\n"
        f"static const REAL side_{number}[{len(flat)}][2] = {{{degrees}}};\n"
    )


def _levels(number: int, n_terms: int, found: list[tuple[int, int]], *, sums: bool = False) -> str:
    """Return the statements that gather the strength of every term."""
    lines = [f"    for (i = 0; i < {n_terms}; i++)", f"        level_{number}[i] = C(0.0);"]
    for rule, term in found:
        level = f"level_{number}[{term}]"
        lines.append(
            f"    {level} += w[{rule}];" if sums else f"    if (w[{rule}] > {level})\n        {level} = w[{rule}];"
        )
    return "\n".join(lines) + "\n"
