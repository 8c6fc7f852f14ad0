"""C code from firing strengths to crisp outputs: exact for piecewise-linear sets, weighted averages, or samples."""

from __future__ import annotations

from fuzzy import sets
from fuzzy.compiler import methods
from fuzzy.compiler.outputs import compile_outputs
from fuzzy.errors import InvalidSystemError
from fuzzy.export.c_exact import exact_centroid
from fuzzy.export.c_functions import IMPLICATIONS, S_NORMS, Shapes, constant, two_argument_function
from fuzzy.export.c_lines import lines
from fuzzy.export.c_parts import Code, members, result
from fuzzy.kernels import codes
from fuzzy.shapes import Linear
from fuzzy.system import FuzzySystem, Sampling


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
    is_centroid = inference.defuzzifier in ("centroid", "center_of_sums")
    if isinstance(inference.resolution, Sampling):
        if not is_centroid:
            raise _refused(f"the defuzzifier '{inference.defuzzifier}' over samples", "inference.defuzzifier")
        if inference.resolution.rule == "polygon":
            raise _refused("centroid of a polygon", "inference.resolution.rule")
        return _sampled(system, shapes)
    if not all(sets.is_linear(term) for output in system.outputs for term in output.terms):
        raise _refused("an exact centroid of curved sets", "inference.resolution")
    joined = methods.aggregation(inference)
    if is_centroid and inference.implication in ("min", "product") and joined in ("max", "sum"):
        return exact_centroid(system)
    if inference.implication not in methods.STRAIGHT_IMPLICATIONS:
        raise _refused(f"an exact result under the implication '{inference.implication}'", "inference.implication")
    if joined not in methods.STRAIGHT_AGGREGATIONS:
        raise _refused(f"an exact result under the aggregation '{joined}'", "inference.aggregation")
    return lines(system)


def _refused(what: str, path: str) -> InvalidSystemError:
    return InvalidSystemError(f"C code has no {what}: choose a sampled resolution, or a lookup table (--table N)", path)


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
        statements += result(system, number, value, "area > C(0.0)")
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
    joined = methods.aggregation(inference)
    if joined not in S_NORMS:
        raise _refused(f"the aggregation '{joined}'", "inference.aggregation")
    tables, _ = compile_outputs(system.outputs, inference)
    definitions = two_argument_function("implied", IMPLICATIONS[inference.implication])
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
        statements += result(system, number, f"{middle} + moment / area", "area > C(0.0)")
    return Code(definitions, statements)
