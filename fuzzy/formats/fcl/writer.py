"""A system as .fcl: the standard's points and singletons, jFuzzyLogic's words for what the standard has none for.

AND and OR never stand side by side without brackets, since jFuzzyLogic reads them otherwise than the standard.
"""

from __future__ import annotations

import itertools
import math

from fuzzy.conversion import converted
from fuzzy.errors import InvalidSystemError
from fuzzy.formats.assembly import resolution_mark
from fuzzy.formats.fcl import words
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
    kind,
)
from fuzzy.system import And, Expression, FuzzySystem, Hedged, Is, Not, Or, Output, Rule, Sampling, Term, Variable

_RESERVED = frozenset(
    (
        *("if", "then", "is", "not", "and", "or", "with", "rule", "term", "range", "method", "accu", "act", "default"),
        *("nc", "real", "var_input", "var_output", "end_var", "fuzzify", "end_fuzzify", "defuzzify", "end_defuzzify"),
        *("ruleblock", "end_ruleblock", "function_block", "end_function_block", "option", "end_option", "function"),
        *("singletons", "abs", "exp", "ln", "log", "sin", "cos", "tan", "enabled", "lock", "none", "inf", "nan"),
        *(word.lower() for word in (*words.CONJUNCTIONS, *words.ACCUMULATIONS, *words.METHODS, *words.SHAPES, "COGF")),
    )
)
CONJUNCTIONS = {word: words.CONJUNCTIONS[word] for word in ("MIN", "PROD", "BDIF", "DMIN", "NIPMIN", "HAMACHER")}
DISJUNCTIONS = {word: words.DISJUNCTIONS[word] for word in ("MAX", "ASUM", "BSUM", "DMAX", "NIPMAX", "EINSTEIN")}
ACTIVATIONS = {"MIN": "min", "PROD": "product"}
ACCUMULATIONS = {"MAX": "max", "BSUM": "bounded_sum", "PROBOR": "algebraic_sum", "SUM": "sum"}
METHODS = {word: words.METHODS[word] for word in ("COG", "COGS", "COA", "LM", "RM", "MM")}


def write(system: FuzzySystem, adapter: Adapter) -> str:
    """Return the text of a valid system.

    Raises:
        InvalidSystemError: For what the format cannot say, unless the adapter takes substitutes and there is one.
    """
    check_inputs(adapter, system)
    system = named(adapter, system, _RESERVED)
    lines = [] if _is_native(system) else [f"(* {resolution_mark(system.inference.resolution)} *)"]
    lines.append(f"FUNCTION_BLOCK {system.name}")
    for word, variables in (("VAR_INPUT", system.inputs), ("VAR_OUTPUT", system.outputs)):
        lines += ["", word, *(f"  {entry.name} : REAL;" for entry in variables), "END_VAR"]
    for entry in system.inputs:
        lines += ["", f"FUZZIFY {entry.name}", *_variable(entry, system, adapter), "END_FUZZIFY"]
    for output in system.outputs:
        lines += ["", f"DEFUZZIFY {output.name}", *_output(output, system, adapter), "END_DEFUZZIFY"]
    inference = system.inference
    activation = "MIN"
    if not has_weighted_outputs(system):
        activation = adapter.word(ACTIVATIONS, inference.implication, "inference.implication", "min")
    lines += [
        "",
        "RULEBLOCK rules",
        f"  AND : {adapter.word(CONJUNCTIONS, inference.conjunction, 'inference.and', 'min')};",
        f"  OR : {adapter.word(DISJUNCTIONS, inference.disjunction, 'inference.or', 'max')};",
        f"  ACT : {activation};",
        *(f"  RULE {number} : {_rule(rule, system, adapter)};" for number, rule in enumerate(all_rules(system), 1)),
        "END_RULEBLOCK",
        "",
        "END_FUNCTION_BLOCK",
    ]
    return "\n".join(lines) + "\n"


def _is_native(system: FuzzySystem) -> bool:
    return system.inference.resolution == ("exact" if has_weighted_outputs(system) else Sampling(1000, "left"))


def _variable(entry: Variable, system: FuzzySystem, adapter: Adapter) -> list[str]:
    is_output = isinstance(entry, Output)
    path = f"{'outputs' if is_output else 'inputs'}.{entry.name}"
    is_crisp = is_output and has_weighted_outputs(system)
    lines = [f"  RANGE := ({digits(entry.low)} .. {digits(entry.high)});"]
    for term in entry.terms:
        said = _term(term, entry, adapter, f"{path}.terms.{term.name}", is_crisp=is_crisp)
        lines.append(f"  TERM {term.name} := {said};")
    return lines


def _output(output: Output, system: FuzzySystem, adapter: Adapter) -> list[str]:
    inference = system.inference
    substitute = {"som_abs": "som", "lom_abs": "lom"}.get(inference.defuzzifier, "centroid")
    is_weighted = has_weighted_outputs(system)
    method = adapter.word(METHODS, inference.defuzzifier, "inference.defuzzifier", None if is_weighted else substitute)
    accumulation = "MAX" if weighted_aggregation(inference) == "max" else "SUM"
    if not is_weighted:
        accumulation = adapter.word(ACCUMULATIONS, inference.aggregation, "inference.aggregation", "max")
    lines = [*_variable(output, system, adapter), f"  METHOD : {method};", f"  ACCU : {accumulation};"]
    match output.no_fire.policy:
        case "default":
            lines.append(f"  DEFAULT := {digits(output.no_fire.value)};")
        case "midpoint":
            lines.append(f"  DEFAULT := {digits(0.5 * (output.low + output.high))};")
        case "hold":
            lines.append("  DEFAULT := NC;")
        case "nan":
            pass
    return lines


def _term(term: Term, entry: Variable, adapter: Adapter, path: str, *, is_crisp: bool) -> str:
    if is_crisp:
        if isinstance(term.shape, Singleton):
            return digits(term.shape.value)
        raise InvalidSystemError(f"{adapter.title} cannot say '{kind(term.shape)}' in a weighted average", path)
    points = _points(_bounded_sides(term.shape, entry))
    if points is not None and (term.height != 1 or term.complement):
        has_jumps = any(left[0] == right[0] for left, right in itertools.pairwise(points))
        if not (term.complement and has_jumps):
            degrees = [1 - degree if term.complement else degree for _, degree in points]
            return _said([(x, term.height * degree) for (x, _), degree in zip(points, degrees, strict=True)])
    if term.complement:
        adapter.cannot(f"the complement of a {kind(term.shape)}", path, "the set itself")
    if term.height != 1 and points is None:
        adapter.cannot(f"the height {term.height:g} of a {kind(term.shape)}", path, "height 1")
    said = _set(_bounded_sides(term.shape, entry), entry)
    if said is None:
        substitute = converted(term.shape, "trapezoid")
        said = _set(_bounded_sides(substitute, entry), entry)
        assert said is not None, "every trapezoid can be said"
        adapter.cannot(f"the shape '{kind(term.shape)}'", path, said)
    return said


def _bounded_sides(shape: Shape, entry: Variable) -> Shape:
    """Return a set without infinite means or ends; triangles and trapezoids may be open, as points can say it."""
    return shape if isinstance(shape, Triangle | Trapezoid) else bounded(shape, entry.low, entry.high)


def _points(shape: Shape) -> list[tuple[float, float]] | None:
    """Return a piecewise-linear set as points, open sides as constants; None for curves and single points."""
    match shape:
        case Triangle(a=a, b=b, c=c):
            corners = [(a, 0.0), (b, 1.0), (c, 0.0)]
        case Trapezoid(a=a, b=b, c=c, d=d):
            corners = [(a, 0.0), (b, 1.0), (c, 1.0), (d, 0.0)]
        case Rectangle(a=a, b=b):
            corners = [(a, 0.0), (a, 1.0), (b, 1.0), (b, 0.0)]
        case Ramp(start=start, end=end):
            corners = sorted([(start, 0.0), (end, 1.0)])
        case Points(points=points):
            corners = list(points)
        case _:
            return None
    finite = [point for point in corners if math.isfinite(point[0])]
    # Three points at one place say no more than the outer two and the highest.
    return finite if len({x for x, _ in finite}) > 1 else None


def _said(points: list[tuple[float, float]]) -> str:
    return " ".join(f"({join(point, ', ')})" for point in points)


def _set(shape: Shape, entry: Variable) -> str | None:  # noqa: C901
    """Return what stands behind ``:=``; None where there is no word."""
    points = _points(shape)
    is_strict = points is not None and all(left[0] < right[0] for left, right in itertools.pairwise(points))
    match shape:
        case Triangle() | Trapezoid() | Rectangle() if points is None or not is_strict:
            closed = bounded(shape, entry.low, entry.high)
            match closed:
                case Triangle(a=a, b=b, c=c):
                    return f"TRIAN {join((a, b, c))}"
                case Trapezoid(a=a, b=b, c=c, d=d):
                    return f"TRAPE {join((a, b, c, d))}"
                case Rectangle(a=a, b=b):
                    return f"TRAPE {join((a, a, b, b))}"
        case Points() if points is None:
            return _said(list(shape.points))
        case Singleton(value=value):
            return f"TRIAN {join((value, value, value))}"
        case Gaussian(mean=mean, sigma=sigma):
            return f"GAUSS {join((mean, sigma))}"
        case Gaussian2():
            if shape.left_mean > shape.right_mean:
                return None
            return f"GAUSS2 {join((shape.left_mean, shape.left_sigma, shape.right_mean, shape.right_sigma))}"
        case Bell(center=center, width=width, slope=slope):
            return f"GBELL {join((width, slope, center))}"
        case Sigmoid(center=center, slope=slope):
            return f"SIGM {join((slope, center))}"
        case SigmoidDifference(left_slope=left, right_slope=right):
            # jFuzzyLogic takes 0 where the difference is negative, the document its magnitude.
            if left != right or (shape.left_center - shape.right_center) * left > 0:
                return None
            return f"DSIGM {join((left, shape.left_center, right, shape.right_center))}"
        case Cosine(center=center, width=width):
            return f"COSINE {join((width / 2, center))}"
        case SShape() | ZShape() | PiShape() | SigmoidProduct() | Spike() | Concave() | Linear():
            return None
    assert points is not None, "what is left is piecewise linear"
    return _said(points)


def _rule(rule: Rule, system: FuzzySystem, adapter: Adapter) -> str:
    inputs = {entry.name for entry in system.inputs}
    consequents = ", ".join(f"{entry.variable} IS {entry.term}" for entry in rule.consequents)
    weight = "" if rule.weight == 1 else f" WITH {digits(rule.weight)}"
    return f"IF {_expression(rule.antecedent, inputs, adapter)} THEN {consequents}{weight}"


def _expression(expression: Expression, inputs: set[str], adapter: Adapter) -> str:
    match expression:
        case Is(variable=variable, term=term):
            if variable not in inputs:
                raise InvalidSystemError(
                    f"{adapter.title} cannot say that '{variable}', an output, is asked for", "rules"
                )
            return f"{variable} IS {term}"
        case Not(operand=Is(variable=variable, term=term)) if variable in inputs:
            return f"{variable} IS NOT {term}"
        case Not(operand=operand):
            return f"NOT ({_expression(operand, inputs, adapter)})"
        case Hedged(hedge=hedge):
            raise InvalidSystemError(f"{adapter.title} cannot say the hedge '{hedge}'", "rules")
        case And(operands=operands) | Or(operands=operands):
            word = " AND " if isinstance(expression, And) else " OR "
            return word.join(
                f"({text})" if isinstance(operand, And | Or) else text
                for operand, text in ((operand, _expression(operand, inputs, adapter)) for operand in operands)
            )
