"""A system as FML, valid by the standard's schema but for names that are no XML identifiers."""

from __future__ import annotations

import math
from collections.abc import Iterator
from xml.sax.saxutils import escape, quoteattr

from fuzzy.conversion import converted
from fuzzy.errors import InvalidSystemError
from fuzzy.formats import literals
from fuzzy.formats.assembly import resolution_mark
from fuzzy.formats.fml import words
from fuzzy.formats.saying import Adapter, bounded, check_inputs, digits
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
    parameters,
)
from fuzzy.system import WEIGHTED_VALUES, FuzzySystem, Is, Output, Rule, Sampling, Term, Variable

_CONJUNCTIONS = {
    **words.SCHEMA_CONJUNCTIONS,
    **{word: meaning for word, meaning in words.CONJUNCTIONS.items() if word not in ("BDIF", "DRP")},
}


def write(system: FuzzySystem, adapter: Adapter) -> str:
    """Return the text of a valid system.

    Raises:
        InvalidSystemError: For what the format cannot say, unless the adapter takes substitutes and there is one.
    """
    check_inputs(adapter, system)
    return "\n".join(_lines(system, adapter)) + "\n"


def _lines(system: FuzzySystem, adapter: Adapter) -> Iterator[str]:
    inference = system.inference
    yield '<?xml version="1.0" encoding="UTF-8"?>'
    if inference.resolution != Sampling(2000, "left_with_break_points"):
        yield f"<!-- {resolution_mark(inference.resolution)} -->"
    yield f'<fuzzySystem xmlns="http://www.ieee1855.org" name={_quoted(system.name, "name", adapter)}>'
    yield "  <knowledgeBase>"
    for entry in system.inputs:
        yield from _variable(entry, f"inputs.{entry.name}", '"input"', adapter)
    substitute = {"som_abs": "som", "lom_abs": "lom"}.get(inference.defuzzifier, "centroid")
    is_weighted = inference.defuzzifier in WEIGHTED_VALUES
    method = adapter.word(
        words.DEFUZZIFIERS, inference.defuzzifier, "inference.defuzzifier", None if is_weighted else substitute
    )
    accumulation = adapter.word(words.DISJUNCTIONS, inference.aggregation, "inference.aggregation", "max")
    for output in system.outputs:
        default = digits(_default(output, adapter))
        more = f'"output" accumulation="{accumulation}" defuzzifier="{method}" defaultValue="{default}"'
        yield from _variable(output, f"outputs.{output.name}", more, adapter)
    yield "  </knowledgeBase>"
    activation = adapter.word(_CONJUNCTIONS, inference.implication, "inference.implication", "min")
    conjunction = adapter.word(_CONJUNCTIONS, inference.conjunction, "inference.and", "min")
    disjunction = adapter.word(words.DISJUNCTIONS, inference.disjunction, "inference.or", "max")
    methods = f'andMethod="{conjunction}" orMethod="{disjunction}"'
    yield f'  <mamdaniRuleBase name="rules" activationMethod="{activation}" {methods}>'
    for number, rule in enumerate(all_rules(system), 1):
        yield from _rule(rule, number, methods, system, adapter)
    yield "  </mamdaniRuleBase>"
    yield "</fuzzySystem>"


def _quoted(name: str, path: str, adapter: Adapter) -> str:
    return quoteattr(_name(name, path, adapter))


def _name(name: str, path: str, adapter: Adapter) -> str:
    """Return a name without double blanks, which XML takes for one."""
    plain = " ".join(name.split())
    if plain != name:
        adapter.cannot(f"the name '{name}' with its blanks", path, f"'{plain}'")
    return plain


def _default(output: Output, adapter: Adapter) -> float:
    middle = 0.5 * (output.low + output.high)
    policy = output.no_fire.policy
    if policy in ("hold", "nan"):
        adapter.cannot(f"no_fire: {policy}", f"outputs.{output.name}.no_fire", f"{{default: {middle:g}}}")
    return output.no_fire.value if policy == "default" else middle


def _variable(entry: Variable, path: str, kind_and_more: str, adapter: Adapter) -> Iterator[str]:
    unit = quoteattr(" ".join(entry.unit.split()))
    ends = f'domainleft="{digits(entry.low)}" domainright="{digits(entry.high)}"'
    yield f"    <fuzzyVariable name={_quoted(entry.name, path, adapter)} scale={unit} {ends} type={kind_and_more}>"
    for term in entry.terms:
        yield from _term(term, entry, f"{path}.terms.{term.name}", adapter)
    yield "    </fuzzyVariable>"


def _term(term: Term, entry: Variable, path: str, adapter: Adapter) -> Iterator[str]:
    if term.height != 1:
        adapter.cannot(f"the height {term.height:g}", path, "height 1")
    said = _shape(term.shape, entry)
    if said is None:
        substitute = converted(term.shape, "trapezoid")
        said = _shape(substitute, entry)
        assert said is not None, "every trapezoid can be said"
        adapter.cannot(f"the shape '{kind(term.shape)}'", path, "a trapezoid")
    complement = "true" if term.complement else "false"
    yield f'      <fuzzyTerm name={_quoted(term.name, path, adapter)} complement="{complement}">'
    yield f"        {said}"
    yield "      </fuzzyTerm>"


def _shape(shape: Shape, entry: Variable) -> str | None:  # noqa: C901
    """Return the element of a shape; None where there is none."""
    match shape:
        case Gaussian2(left_mean=left, right_mean=right):
            if left == -math.inf:
                return _element("leftGaussianShape", (right, shape.right_sigma))
            if right == math.inf:
                return _element("rightGaussianShape", (left, shape.left_sigma))
            return None
        case PiShape(a=a, b=b, c=c, d=d):
            return _element("piShape", (a, b)) if b == c and a < b and d == b + abs(b - a) else None
        case Ramp(start=start, end=end):
            rises = start < end
            return _element("rightLinearShape", (start, end)) if rises else _element("leftLinearShape", (end, start))
        case Points(points=points):
            inside = "".join(f'<point x="{digits(x)}" y="{digits(y)}"/>' for x, y in points)
            return f'<pointSetShape interpolationMethod="linear">{inside}</pointSetShape>'
        case Triangle() | Trapezoid() | Rectangle():
            closed = bounded(shape, entry.low, entry.high)
            words_of = {Triangle: "triangularShape", Trapezoid: "trapezoidShape", Rectangle: "rectangularShape"}
            return _element(words_of[type(closed)], parameters(closed))  # type: ignore[index]
        case Gaussian():
            return _element("gaussianShape", parameters(shape))
        case Singleton():
            return _element("singletonShape", parameters(shape))
        case SShape():
            return _element("sShape", parameters(shape))
        case ZShape():
            return _element("zShape", parameters(shape))
        case Bell() | Sigmoid() | SigmoidDifference() | SigmoidProduct() | Cosine() | Spike() | Concave() | Linear():
            return None


def _element(tag: str, values: tuple[float, ...]) -> str:
    attributes = " ".join(f'param{place}="{digits(value)}"' for place, value in enumerate(values, 1))
    return f"<{tag} {attributes}/>"


def _rule(rule: Rule, number: int, methods: str, system: FuzzySystem, adapter: Adapter) -> Iterator[str]:
    path = f"the rule '{format_rule(rule)}'"
    chain = literals.chain(rule.antecedent)
    if chain is None:
        raise InvalidSystemError(f"{adapter.title} cannot say {path}: it joins propositions by AND alone or OR alone")
    connector = "or" if chain.is_or else "and"
    weight = digits(rule.weight)
    yield f'    <rule name="rule{number}" {methods} connector="{connector}" weight="{weight}">'
    yield "      <antecedent>"
    inputs = {entry.name for entry in system.inputs}
    for literal in chain.literals:
        if literal.proposition.variable not in inputs:
            message = f"{adapter.title} cannot say {path}: '{literal.proposition.variable}' is an output"
            raise InvalidSystemError(message)
        yield _clause(literal.proposition, _modifier(literal, path, adapter), adapter)
    yield "      </antecedent>"
    yield "      <consequent><then>"
    for consequent in rule.consequents:
        yield _clause(consequent, "", adapter)
    yield "      </then></consequent>"
    yield "    </rule>"


def _modifier(literal: literals.Literal, path: str, adapter: Adapter) -> str:
    modifiers = [*literal.hedges, *(["not"] if literal.is_negated else [])]
    if len(modifiers) > 1:
        said = " ".join(reversed(modifiers))
        raise InvalidSystemError(f"{adapter.title} cannot say '{said}' in {path}: a clause has one modifier")
    return f' modifier="{modifiers[0]}"' if modifiers else ""


def _clause(proposition: Is, modifier: str, adapter: Adapter) -> str:
    variable = escape(_name(proposition.variable, "rules", adapter))
    term = escape(_name(proposition.term, "rules", adapter))
    return f"        <clause{modifier}><variable>{variable}</variable><term>{term}</term></clause>"
