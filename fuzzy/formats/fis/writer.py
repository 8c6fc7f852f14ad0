"""A system as .fis, in the words that MATLAB and Octave share, and Octave's for what MATLAB has no word for."""

from __future__ import annotations

from collections.abc import Iterator

from fuzzy.conversion import converted
from fuzzy.errors import InvalidSystemError
from fuzzy.formats import literals
from fuzzy.formats.assembly import resolution_mark
from fuzzy.formats.fis import words
from fuzzy.formats.saying import Adapter, bounded, check_inputs, digits, join, weighted_aggregation
from fuzzy.language import format_rule
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
from fuzzy.system import WEIGHTED_VALUES, FuzzySystem, Input, Is, Output, Rule, Sampling, Term, Variable

_HEDGES = {hedges: code for code, hedges in words.OCTAVE_HEDGES.items()}


def write(system: FuzzySystem, adapter: Adapter) -> str:
    """Return the text of a valid system.

    Raises:
        InvalidSystemError: For what the format cannot say, unless the adapter takes substitutes and there is one.
    """
    check_inputs(adapter, system)
    rules = [part for rule in all_rules(system) for part in literals.one_conclusion_each(rule)]
    lines = [f"% {resolution_mark(system.inference.resolution)}"] if not _is_native(system) else []
    lines += ["[System]", f"Name='{_name(adapter, system.name, 'name')}'", *_operators(system, adapter, len(rules))]
    for number, entry in enumerate(system.inputs, 1):
        lines += ["", f"[Input{number}]", *_variable(entry, adapter, f"inputs.{entry.name}", is_sugeno=False)]
    is_sugeno = system.inference.defuzzifier in WEIGHTED_VALUES
    for number, output in enumerate(system.outputs, 1):
        _check_no_fire(output, adapter)
        path = f"outputs.{output.name}"
        lines += ["", f"[Output{number}]", *_variable(output, adapter, path, is_sugeno=is_sugeno)]
    lines += ["", "[Rules]", *(_rule(rule, system, adapter) for rule in rules)]
    return "\n".join(lines) + "\n"


def _is_native(system: FuzzySystem) -> bool:
    """Tell whether engines that read the file take the points that the system takes."""
    inference = system.inference
    if inference.defuzzifier in WEIGHTED_VALUES:
        return inference.resolution == "exact"
    if inference.resolution == Sampling(101, "trapezoid"):
        return inference.defuzzifier == "centroid"
    return inference.resolution == Sampling(101, "endpoints")


def _name(adapter: Adapter, name: str, path: str) -> str:
    if "'" not in name and '"' not in name:
        return name
    plain = name.replace("'", "_").replace('"', "_")
    adapter.cannot(f"the name {name!r} with its quotes", path, f"'{plain}'")
    return plain


def _operators(system: FuzzySystem, adapter: Adapter, n_rules: int) -> Iterator[str]:
    inference = system.inference
    is_weighted = inference.defuzzifier in WEIGHTED_VALUES
    yield f"Type='{'sugeno' if is_weighted else 'mamdani'}'"
    yield "Version=2.0"
    yield f"NumInputs={len(system.inputs)}"
    yield f"NumOutputs={len(system.outputs)}"
    yield f"NumRules={n_rules}"
    yield f"AndMethod='{adapter.word(words.CONJUNCTIONS, inference.conjunction, 'inference.and', 'min')}'"
    yield f"OrMethod='{adapter.word(words.DISJUNCTIONS, inference.disjunction, 'inference.or', 'max')}'"
    implication, aggregation = "prod", "sum"
    if is_weighted and weighted_aggregation(inference) != "sum":
        adapter.cannot(
            "that only the strongest of the rules with one conclusion counts", "inference.aggregation", "sum"
        )
    if not is_weighted:
        implication = adapter.word(words.IMPLICATIONS, inference.implication, "inference.implication", "min")
        aggregation = adapter.word(words.AGGREGATIONS, inference.aggregation, "inference.aggregation", "max")
    yield f"ImpMethod='{implication}'"
    yield f"AggMethod='{aggregation}'"
    substitute = {"som": "som_abs", "lom": "lom_abs"}.get(inference.defuzzifier, "centroid")
    method = adapter.word(words.DEFUZZIFIERS, inference.defuzzifier, "inference.defuzzifier", substitute)
    if method == "centroid" and inference.resolution == Sampling(101, "trapezoid"):
        method = "centroid_integral"
    yield f"DefuzzMethod='{method}'"


def _variable(entry: Variable, adapter: Adapter, path: str, *, is_sugeno: bool) -> Iterator[str]:
    yield f"Name='{_name(adapter, entry.name, path)}'"
    yield f"Range=[{join((entry.low, entry.high))}]"
    yield f"NumMFs={len(entry.terms)}"
    for number, term in enumerate(entry.terms, 1):
        place = f"{path}.terms.{term.name}"
        if term.height != 1:
            adapter.cannot(f"the height {term.height:g}", place, "height 1")
        word, values = _membership(term, entry, adapter, place, is_sugeno=is_sugeno)
        yield f"MF{number}='{_name(adapter, term.name, place)}':'{word}',[{join(values)}]"


def _membership(
    term: Term, entry: Variable, adapter: Adapter, path: str, *, is_sugeno: bool
) -> tuple[str, tuple[float, ...]]:
    match term.shape:
        case Singleton(value=value) if is_sugeno:
            return "constant", (value,)
        case Linear(coefficients=coefficients, constant=constant):
            return "linear", (*coefficients, constant)
    if is_sugeno:
        raise InvalidSystemError(f"{adapter.title} cannot say a Tsukamoto system, whose outputs have sets", path)
    found = _set(bounded(term.shape, entry.low, entry.high))
    if found is None:
        substitute = converted(term.shape, "trapezoid")
        found = _set(bounded(substitute, entry.low, entry.high))
        assert found is not None, "every trapezoid can be said"
        adapter.cannot(f"the shape '{kind(term.shape)}'", path, f"{found[0]} [{join(found[1])}]")
    return found


def _set(shape: Shape) -> tuple[str, tuple[float, ...]] | None:  # noqa: C901
    """Return the word and the parameters of a set without infinite ones; None where there is no word."""
    match shape:
        case Triangle(a=a, b=b, c=c):
            return "trimf", (a, b, c)
        case Trapezoid(a=a, b=b, c=c, d=d):
            return "trapmf", (a, b, c, d)
        case Rectangle(a=a, b=b):
            return "trapmf", (a, a, b, b)
        case Singleton(value=value):
            return "trimf", (value, value, value)
        case Ramp(start=start, end=end):
            return ("linsmf", (start, end)) if start < end else ("linzmf", (end, start))
        case Gaussian(mean=mean, sigma=sigma):
            return "gaussmf", (sigma, mean)
        case Gaussian2():
            return "gauss2mf", (shape.left_sigma, shape.left_mean, shape.right_sigma, shape.right_mean)
        case Bell(center=center, width=width, slope=slope):
            return "gbellmf", (width, slope, center)
        case Sigmoid(center=center, slope=slope):
            return "sigmf", (slope, center)
        case SigmoidDifference() | SigmoidProduct():
            word = "dsigmf" if isinstance(shape, SigmoidDifference) else "psigmf"
            return word, (shape.left_slope, shape.left_center, shape.right_slope, shape.right_center)
        case SShape(a=a, b=b):
            return "smf", (a, b)
        case ZShape(a=a, b=b):
            return "zmf", (a, b)
        case PiShape(a=a, b=b, c=c, d=d):
            return "pimf", (a, b, c, d)
        case Points() | Cosine() | Spike() | Concave() | Linear():
            return None


def _check_no_fire(output: Output, adapter: Adapter) -> None:
    """Note a policy other than the middle of the range, MATLAB's."""
    policy, value = output.no_fire.policy, output.no_fire.value
    if policy == "midpoint" or (policy == "default" and value == 0.5 * (output.low + output.high)):
        return
    said = f"no_fire: {{default: {value:g}}}" if policy == "default" else f"no_fire: {policy}"
    adapter.cannot(said, f"outputs.{output.name}.no_fire", "midpoint, as MATLAB does")


def _rule(rule: Rule, system: FuzzySystem, adapter: Adapter) -> str:
    path = f"the rule '{format_rule(rule)}'"
    chain = literals.chain(rule.antecedent)
    if chain is None:
        raise InvalidSystemError(f"{adapter.title} cannot say {path}: it joins propositions by AND alone or OR alone")
    codes = dict.fromkeys((entry.name for entry in system.inputs), "0")
    for literal in chain.literals:
        variable = literal.proposition.variable
        if variable not in codes:
            raise InvalidSystemError(f"{adapter.title} cannot say {path}: '{variable}' is an output")
        if codes[variable] != "0":
            raise InvalidSystemError(f"{adapter.title} cannot say {path}: '{variable}' stands in it twice")
        entry = next(entry for entry in system.inputs if entry.name == variable)
        codes[variable] = _code(literal, entry, adapter, path)
    conclusions = dict.fromkeys((entry.name for entry in system.outputs), "0")
    for consequent in rule.consequents:
        output = next(entry for entry in system.outputs if entry.name == consequent.variable)
        number, term = _numbered(output, consequent)
        conclusions[consequent.variable] = f"{'-' if term.complement else ''}{number}"
    return (
        f"{' '.join(codes.values())}, {' '.join(conclusions.values())} ({digits(rule.weight)}) : "
        f"{2 if chain.is_or else 1}"
    )


def _numbered(entry: Input | Output, proposition: Is) -> tuple[int, Term]:
    return next((number, term) for number, term in enumerate(entry.terms, 1) if term.name == proposition.term)


def _code(literal: literals.Literal, entry: Input, adapter: Adapter, path: str) -> str:
    number, term = _numbered(entry, literal.proposition)
    if literal.hedges and (literal.hedges not in _HEDGES or term.complement):
        said = " ".join(reversed(literal.hedges))
        raise InvalidSystemError(f"{adapter.title} cannot say '{said} {term.name}' in {path}")
    hedge = f".{_HEDGES[literal.hedges]}" if literal.hedges else ""
    return f"{'-' if literal.is_negated != term.complement else ''}{number}{hedge}"
