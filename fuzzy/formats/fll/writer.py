"""A system as .fll, which fuzzylite reads; numbers are written in full, not with its three decimals."""

from __future__ import annotations

import math
from collections.abc import Iterator

from fuzzy.errors import InvalidSystemError
from fuzzy.formats.assembly import resolution_mark
from fuzzy.formats.fll import words
from fuzzy.formats.saying import (
    Adapter,
    bounded,
    check_inputs,
    digits,
    has_weighted_outputs,
    join,
    named,
    weighted_aggregation,
)
from fuzzy.rules import all_rules
from fuzzy.shapes import (
    Bell,
    Concave,
    Cosine,
    Gaussian,
    Gaussian2,
    Linear,
    PiShape,
    Points,
    Ramp,
    Rectangle,
    Shape,
    Sigmoid,
    SigmoidDifference,
    SigmoidProduct,
    Singleton,
    Spike,
    SShape,
    Trapezoid,
    Triangle,
    ZShape,
    parameters,
)
from fuzzy.system import And, Expression, FuzzySystem, Hedged, Is, Not, Or, Output, Rule, Sampling, Variable

_RESERVED = frozenset({"if", "then", "is", "not", "and", "or", "with", *words.HEDGES})
_HEDGES = {meaning: word for word, meaning in words.HEDGES.items()}


def write(system: FuzzySystem, adapter: Adapter) -> str:
    """Return the text of a valid system.

    Raises:
        InvalidSystemError: For what the format cannot say, unless the adapter takes substitutes and there is one.
    """
    check_inputs(adapter, system)
    system = named(adapter, system, _RESERVED)
    lines = [] if _is_native(system) else [f"# {resolution_mark(system.inference.resolution)}"]
    lines.append(f"Engine: {system.name}")
    for entry in system.inputs:
        lines += [f"InputVariable: {entry.name}", *_variable(entry, adapter, f"inputs.{entry.name}", is_weighted=False)]
    for output in system.outputs:
        lines += [f"OutputVariable: {output.name}", *_output(output, system, adapter)]
    inference = system.inference
    is_weighted = has_weighted_outputs(system)
    lines += [
        "RuleBlock: rules",
        "  enabled: true",
        f"  conjunction: {adapter.word(words.CONJUNCTIONS, inference.conjunction, 'inference.and', 'min')}",
        f"  disjunction: {adapter.word(words.DISJUNCTIONS, inference.disjunction, 'inference.or', 'max')}",
        f"  implication: {'none' if is_weighted else _implication(system, adapter)}",
        "  activation: General",
        *(f"  rule: {_rule(rule, system, adapter)}" for rule in all_rules(system)),
    ]
    return "\n".join(lines) + "\n"


def _is_native(system: FuzzySystem) -> bool:
    resolution = system.inference.resolution
    if has_weighted_outputs(system):
        return resolution == "exact"
    return isinstance(resolution, Sampling) and resolution.rule == "midpoints"


def _implication(system: FuzzySystem, adapter: Adapter) -> str:
    return adapter.word(words.CONJUNCTIONS, system.inference.implication, "inference.implication", "min")


def _variable(entry: Variable, adapter: Adapter, path: str, *, is_weighted: bool) -> Iterator[str]:
    yield "  enabled: true"
    yield f"  range: {join((entry.low, entry.high))}"
    yield f"  lock-range: {'false' if isinstance(entry, Output) else 'true'}"
    for term in entry.terms:
        if term.complement and isinstance(entry, Output):
            adapter.cannot("a complemented set", f"{path}.terms.{term.name}", "the set itself")
        word, values = _membership(_bounded(term.shape, entry))
        if word == "Constant" and not (is_weighted and isinstance(entry, Output)):
            # A constant is a number to fuzzylite, not a set.
            word, values = "Triangle", 3 * values
        height = "" if term.height == 1 else f" {digits(term.height)}"
        yield f"  term: {term.name} {word} {join(values)}{height}"


def _bounded(shape: Shape, entry: Variable) -> Shape:
    """Return a set without infinite means or ends, but with the open triangles and trapezoids that fuzzylite knows."""
    return shape if isinstance(shape, Triangle | Trapezoid) else bounded(shape, entry.low, entry.high)


def _output(output: Output, system: FuzzySystem, adapter: Adapter) -> Iterator[str]:
    path = f"outputs.{output.name}"
    variable = list(_variable(output, adapter, path, is_weighted=has_weighted_outputs(system)))
    yield from variable[:3]
    inference = system.inference
    aggregation = "Maximum" if weighted_aggregation(inference) == "max" else "none"
    if not has_weighted_outputs(system):
        aggregation = adapter.word(words.AGGREGATIONS, inference.aggregation, "inference.aggregation", "max")
    yield f"  aggregation: {aggregation}"
    substitute = {"som_abs": "som", "lom_abs": "lom"}.get(inference.defuzzifier, "centroid")
    method = adapter.word(words.DEFUZZIFIERS, inference.defuzzifier, "inference.defuzzifier", substitute)
    yield f"  defuzzifier: {method}{_resolution(system, output)}"
    policy = output.no_fire.policy
    value = {"default": output.no_fire.value, "midpoint": 0.5 * (output.low + output.high)}.get(policy, math.nan)
    yield f"  default: {digits(value) if value == value else 'nan'}"
    yield f"  lock-previous: {'true' if policy == 'hold' else 'false'}"
    yield from variable[3:]


def _resolution(system: FuzzySystem, output: Output) -> str:
    if has_weighted_outputs(system):
        is_constant = all(isinstance(term.shape, Singleton | Linear) for term in output.terms)
        return " TakagiSugeno" if is_constant else " Tsukamoto"
    resolution = system.inference.resolution
    return f" {resolution.points}" if isinstance(resolution, Sampling) else ""


def _membership(shape: Shape) -> tuple[str, tuple[float, ...]]:
    match shape:
        case Singleton(value=value):
            return "Constant", (value,)
        case Points():
            return "Discrete", parameters(shape)
        case Linear(coefficients=coefficients, constant=constant):
            return "Linear", (*coefficients, constant)
        case SigmoidDifference() | SigmoidProduct():
            word = "SigmoidDifference" if isinstance(shape, SigmoidDifference) else "SigmoidProduct"
            return word, (shape.left_center, shape.left_slope, shape.right_slope, shape.right_center)
        case Gaussian2():
            return "GaussianProduct", parameters(shape)
        case Triangle() | Trapezoid() | Rectangle() | Ramp() | Gaussian() | Bell() | Sigmoid():
            return type(shape).__name__, parameters(shape)
        case SShape() | ZShape() | PiShape() | Cosine() | Spike() | Concave():
            return type(shape).__name__, parameters(shape)


def _rule(rule: Rule, system: FuzzySystem, adapter: Adapter) -> str:
    complements = {(entry.name, term.name) for entry in system.inputs for term in entry.terms if term.complement}
    antecedent = _expression(rule.antecedent, complements, adapter)
    consequents = " and ".join(f"{entry.variable} is {entry.term}" for entry in rule.consequents)
    weight = "" if rule.weight == 1 else f" with {digits(rule.weight)}"
    return f"if {antecedent} then {consequents}{weight}"


def _expression(expression: Expression, complements: set[tuple[str, str]], adapter: Adapter) -> str:
    match expression:
        case And(operands=operands) | Or(operands=operands):
            word = " and " if isinstance(expression, And) else " or "
            return word.join(
                f"({text})" if isinstance(operand, And | Or) else text
                for operand, text in ((operand, _expression(operand, complements, adapter)) for operand in operands)
            )
        case Is() | Not() | Hedged():
            return _proposition(expression, complements, adapter)


def _proposition(expression: Is | Not | Hedged, complements: set[tuple[str, str]], adapter: Adapter) -> str:
    """Return "variable is HEDGES term", the outermost hedge first; a complemented set is a last NOT."""
    hedges: list[str] = []
    found: Expression = expression
    while not isinstance(found, Is):
        match found:
            case Not(operand=operand):
                hedges.append("not")
            case Hedged(operand=operand, hedge=hedge):
                if hedge not in _HEDGES:
                    raise InvalidSystemError(f"{adapter.title} cannot say the hedge '{hedge}'", "rules")
                hedges.append(_HEDGES[hedge])
            case And() | Or():
                raise InvalidSystemError(
                    f"{adapter.title} cannot say '{' '.join(hedges)} (…)': hedges act on terms", "rules"
                )
        found = operand
    if (found.variable, found.term) in complements:
        hedges.append("not")
    return f"{found.variable} is {' '.join((*hedges, found.term))}"
