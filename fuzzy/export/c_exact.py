"""C code for centroids of straight sets in closed form: areas and moments between the points where they bend."""

from __future__ import annotations

from fuzzy import geometry, sets
from fuzzy.compiler import methods
from fuzzy.export.c_functions import constant
from fuzzy.export.c_parts import Code, levels, members, result
from fuzzy.system import FuzzySystem, Output

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


def exact_centroid(system: FuzzySystem) -> Code:
    """Return areas and moments of straight sides between the points where the sets bend."""
    is_envelope = methods.aggregation(system.inference) == "max"
    is_clipped = system.inference.implication == "min"
    definitions = ""
    statements = ""
    most = 1
    for number, (output, found) in enumerate(zip(system.outputs, members(system), strict=True)):
        middle = 0.5 * (output.low + output.high)
        knots, sides = sides_of(output)
        most = max(most, *(len(interval) for interval in sides))
        definitions += side_tables(number, knots, sides, middle)
        statements += "    area = moment = C(0.0);\n"
        statements += levels(number, len(output.terms), found) if is_envelope else ""
        loop = _ENVELOPE_LOOP if is_envelope else _SEPARATE_LOOP if is_clipped else _SCALED_LOOP
        if is_envelope:
            statements += loop.format(n=number, intervals=len(sides))
        elif is_clipped:
            statements += "".join(
                loop.format(n=number, intervals=len(sides), rule=rule, term=term) for rule, term in found
            )
        else:
            statements += levels(number, len(output.terms), found, sums=True)
            statements += loop.format(n=number, intervals=len(sides))
        statements += result(system, number, f"{constant(middle)} + moment / area", "area > C(0.0)")
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


def sides_of(output: Output) -> tuple[list[float], list[list[tuple[int, float, float]]]]:
    """Return the knots of an output's sets, and for each interval the terms with their degrees at both ends."""
    segments = [sets.segments(term) for term in output.terms]
    knots = geometry.knots(segments, output.low, output.high)
    sides: list[list[tuple[int, float, float]]] = [[] for _ in knots[1:]]
    for term, parts in enumerate(segments):
        for interval, segment in geometry.sides(parts, knots):
            left, right = knots[interval], knots[interval + 1]
            ends = geometry.degree(segment, left), geometry.degree(segment, right)
            if max(ends) > 0:
                sides[interval].append((term, *ends))
    return knots, sides


def side_tables(number: int, knots: list[float], sides: list[list[tuple[int, float, float]]], middle: float) -> str:
    """Return the tables of one output; places count from ``middle``."""
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
