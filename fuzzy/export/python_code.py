"""A controller as one Python file that needs numpy alone."""

from __future__ import annotations

import inspect
import pprint
from typing import Any

from fuzzy import geometry, sets, shapes
from fuzzy.compiler import methods
from fuzzy.compiler.outputs import compile_outputs, no_fire_value
from fuzzy.errors import InvalidSystemError
from fuzzy.export import standalone, standalone_lines
from fuzzy.export.kernel_source import python_source
from fuzzy.kernels import codes, exact, linear, norms, pieces
from fuzzy.rules import all_rules
from fuzzy.shapes import Linear
from fuzzy.system import And, Expression, FuzzySystem, Hedged, Is, Not, Or, Output, Sampling, Term
from fuzzy.validation import validate


def python_file(system: FuzzySystem) -> str:
    """Return a controller as the text of a Python file with the function ``controller``.

    Raises:
        InvalidSystemError: For what is not exported.
    """
    system = validate(system)
    tables = pprint.pformat(_tables(system), width=110, compact=True, sort_dicts=False)
    # Infinite ends of open sets are the one kind of number that no literal says.
    names = "".join(f"{entry.name} in [{entry.low:g}, {entry.high:g}], " for entry in system.inputs).rstrip(", ")
    outputs = ", ".join(entry.name for entry in system.outputs)
    title = f"A fuzzy controller, written by the fuzzy workbench: {_plain(names)} -> {_plain(outputs)}."
    source = inspect.getsource(standalone).partition('"""\n')[2].lstrip("\n")
    if '"straight"' in tables or "'straight'" in tables:
        source += _straight()
    return (
        f'"""{title}"""\n\n{source}\n\ninf, nan = math.inf, math.nan\n\nSYSTEM = {tables}\n\n\n'
        "def controller(*inputs, last=None):\n"
        '    """Return the crisp output for crisp inputs; a tuple for several outputs."""\n'
        "    outputs = evaluate(SYSTEM, inputs, last)\n"
        "    return outputs[0] if len(outputs) == 1 else outputs\n"
    )


def _straight() -> str:
    """Return the text of what aggregates of straight lines need: kernels, and what calls them."""
    kernels = [linear.add_bend, linear.imply, linear.join, norms.bend_level, exact.sort, pieces.begin, pieces.top]
    driver = inspect.getsource(standalone_lines)
    driver = driver[driver.index("AREA, HALF, TOP") :]
    return f'\n\n{python_source(kernels)}\n\n\n{driver}\n\nMETHODS["straight"] = straight\n'


def _plain(text: str) -> str:
    return text.replace("\\", "/").replace('"', "'")


def _refused(what: str, path: str) -> InvalidSystemError:
    return InvalidSystemError(f"Python code has no {what}: choose a sampled resolution", path)


def _tables(system: FuzzySystem) -> dict[str, Any]:
    inference = system.inference
    return {
        "inputs": [
            {"low": entry.low, "high": entry.high, "terms": [_term(term) for term in entry.terms]}
            for entry in system.inputs
        ],
        "outputs": [_output(system, number) for number in range(len(system.outputs))],
        "rules": _rules(system),
        "and": inference.conjunction,
        "or": inference.disjunction,
        "implication": inference.implication,
        "aggregation": methods.aggregation(inference),
    }


def _term(term: Term) -> tuple[str, tuple[float, ...], float, bool]:
    return shapes.kind(term.shape), shapes.parameters(term.shape), term.height, term.complement


def _output(system: FuzzySystem, number: int) -> dict[str, Any]:
    output, inference = system.outputs[number], system.inference
    is_pointwise = all(map(sets.is_singleton, output.terms))
    found: dict[str, Any] = {
        "low": output.low,
        "high": output.high,
        "silent": None if output.no_fire.policy == "hold" else no_fire_value(output),
        "joins": methods.grouping(inference) == codes.LARGEST_STRENGTH,
        "limits": not (is_pointwise or inference.defuzzifier in methods.SETLESS),
    }
    if not found["limits"]:
        method = "weighted_sum" if inference.defuzzifier == "weighted_sum" else "weighted_average"
        return found | {"method": method, "values": _values(system, number)}
    is_centroid = inference.defuzzifier in ("centroid", "center_of_sums")
    joined = methods.aggregation(inference)
    if isinstance(inference.resolution, Sampling):
        if inference.resolution.rule == "polygon":
            raise _refused("centroid of a polygon", "inference.resolution.rule")
        if not is_centroid:
            raise _refused(f"defuzzifier '{inference.defuzzifier}' over samples", "inference.defuzzifier")
        if joined not in standalone.S_NORMS:
            raise _refused(f"aggregation '{joined}' over samples", "inference.aggregation")
        tables, _ = compile_outputs(system.outputs, inference)
        places = tables.sample[tables.sample_start[number] : tables.sample_start[number + 1]]
        terms = [_term(term) for term in output.terms]
        return found | {"method": "sampled", "terms": terms, "samples": places.tolist()}
    is_straight = all(map(sets.is_linear, output.terms))
    if is_centroid and is_straight and inference.implication in ("min", "product") and joined in ("max", "sum"):
        return found | {"method": "exact", "intervals": _intervals(output)}
    is_said = inference.implication in methods.STRAIGHT_IMPLICATIONS and joined in methods.STRAIGHT_AGGREGATIONS
    if not (is_straight and is_said):
        raise _refused("exact result of these sets and operators", "inference.resolution")
    implication = methods.IMPLICATION[inference.implication]
    return found | {
        "method": "straight",
        "intervals": _intervals(output),
        "implication": implication,
        "aggregation": methods.AGGREGATION[joined],
        "bends_twice": implication == norms.NILPOTENT_MINIMUM,
        "least": 0.0 if implication <= norms.PRODUCT else norms.ROUNDING,
        "halves": inference.defuzzifier == "bisector",
        "which": methods.MAXIMUM.get(inference.defuzzifier, -1),
    }


def _values(system: FuzzySystem, number: int) -> list[float | tuple[float, ...]]:
    output = system.outputs[number]
    tables, _ = compile_outputs(system.outputs, system.inference)
    first = int(tables.term_start[number])
    found: list[float | tuple[float, ...]] = []
    for place, term in enumerate(output.terms):
        if isinstance(term.shape, Linear):
            found.append((*term.shape.coefficients, term.shape.constant))
            continue
        peak = float(tables.peak[first + place])
        if peak != peak:
            raise _refused("Tsukamoto inference", f"outputs.{output.name}.terms.{term.name}")
        found.append(peak)
    return found


def _intervals(output: Output) -> list[tuple[float, float, dict[int, tuple[float, float]]]]:
    """Return the intervals between the points where sets bend, and each term's degrees at both ends."""
    segments = [sets.segments(term) for term in output.terms]
    knots = geometry.knots(segments, output.low, output.high)
    sides: list[dict[int, tuple[float, float]]] = [{} for _ in knots[1:]]
    for term, parts in enumerate(segments):
        for interval, segment in geometry.sides(parts, knots):
            ends = (geometry.degree(segment, knots[interval]), geometry.degree(segment, knots[interval + 1]))
            sides[interval][term] = ends
    return [(knots[i], knots[i + 1], found) for i, found in enumerate(sides)]


def _rules(system: FuzzySystem) -> list[tuple[Any, float, list[tuple[int, int]]]]:
    inputs = {
        (entry.name, term.name): (i, k) for i, entry in enumerate(system.inputs) for k, term in enumerate(entry.terms)
    }
    outputs = {
        (entry.name, term.name): (i, k) for i, entry in enumerate(system.outputs) for k, term in enumerate(entry.terms)
    }
    return [
        (
            _expression(rule.antecedent, inputs),
            rule.weight,
            [outputs[entry.variable, entry.term] for entry in rule.consequents],
        )
        for rule in all_rules(system)
    ]


def _expression(expression: Expression, places: dict[tuple[str, str], tuple[int, int]]) -> tuple[Any, ...]:
    match expression:
        case Is(variable=variable, term=term):
            if (variable, term) not in places:
                raise InvalidSystemError(
                    f"Python code has no rules that ask for an output, as for '{variable}'", "rules"
                )
            return ("is", *places[variable, term])
        case Not(operand=operand):
            return ("not", _expression(operand, places))
        case Hedged(operand=operand, hedge=hedge):
            return ("hedge", hedge, _expression(operand, places))
        case And(operands=operands):
            return ("and", [_expression(operand, places) for operand in operands])
        case Or(operands=operands):
            return ("or", [_expression(operand, places) for operand in operands])
