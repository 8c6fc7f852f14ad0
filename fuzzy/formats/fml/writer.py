"""A system as FML, valid by the standard's schema but for names that are no XML identifiers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from xml.sax.saxutils import escape, quoteattr

from msgspec.structs import replace

from fuzzy.conversion import converted
from fuzzy.errors import InvalidSystemError
from fuzzy.formats import literals
from fuzzy.formats.assembly import resolution_mark
from fuzzy.formats.fml import weighted, words
from fuzzy.formats.fml.elements import default_value, plain_name, quoted_name, shape_element
from fuzzy.formats.saying import Adapter, check_inputs, digits, has_weighted_outputs
from fuzzy.language import format_rule
from fuzzy.rules import all_rules
from fuzzy.shapes import kind
from fuzzy.system import FuzzySystem, Is, Rule, Sampling, Term, Variable

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
    native = "exact" if has_weighted_outputs(system) else Sampling(2000, "left_with_break_points")
    if inference.resolution != native:
        yield f"<!-- {resolution_mark(inference.resolution)} -->"
    yield f'<fuzzySystem xmlns="http://www.ieee1855.org" name={quoted_name(system.name, "name", adapter)}>'
    yield "  <knowledgeBase>"
    for entry in system.inputs:
        yield from _variable(entry, f"inputs.{entry.name}", '"input"', adapter)
    if has_weighted_outputs(system):
        yield from weighted.outputs(system, adapter)
    else:
        yield from _outputs(system, adapter)
    yield "  </knowledgeBase>"
    conjunction = adapter.word(_CONJUNCTIONS, inference.conjunction, "inference.and", "min")
    disjunction = adapter.word(words.DISJUNCTIONS, inference.disjunction, "inference.or", "max")
    methods = f'andMethod="{conjunction}" orMethod="{disjunction}"'
    if has_weighted_outputs(system):
        for base, names in weighted.rule_bases(system).items():
            rules = (_concluding(rule, names) for rule in all_rules(system))
            yield from _rule_base(base, methods, methods, [rule for rule in rules if rule.consequents], system, adapter)
    else:
        activation = adapter.word(_CONJUNCTIONS, inference.implication, "inference.implication", "min")
        attributes = f'activationMethod="{activation}" {methods}'
        yield from _rule_base("mamdaniRuleBase", attributes, methods, all_rules(system), system, adapter)
    yield "</fuzzySystem>"


def _outputs(system: FuzzySystem, adapter: Adapter) -> Iterator[str]:
    inference = system.inference
    substitute = {"som_abs": "som", "lom_abs": "lom"}.get(inference.defuzzifier, "centroid")
    method = adapter.word(words.DEFUZZIFIERS, inference.defuzzifier, "inference.defuzzifier", substitute)
    accumulation = adapter.word(words.DISJUNCTIONS, inference.aggregation, "inference.aggregation", "max")
    for output in system.outputs:
        default = digits(default_value(output, adapter))
        more = f'"output" accumulation="{accumulation}" defuzzifier="{method}" defaultValue="{default}"'
        yield from _variable(output, f"outputs.{output.name}", more, adapter)


def _concluding(rule: Rule, names: frozenset[str]) -> Rule:
    """Return a rule with those of its conclusions that are on the named outputs."""
    return replace(rule, consequents=tuple(entry for entry in rule.consequents if entry.variable in names))


def _variable(entry: Variable, path: str, kind_and_more: str, adapter: Adapter) -> Iterator[str]:
    unit = quoteattr(" ".join(entry.unit.split()))
    ends = f'domainleft="{digits(entry.low)}" domainright="{digits(entry.high)}"'
    yield f"    <fuzzyVariable name={quoted_name(entry.name, path, adapter)} scale={unit} {ends} type={kind_and_more}>"
    for term in entry.terms:
        yield from _term(term, entry, f"{path}.terms.{term.name}", adapter)
    yield "    </fuzzyVariable>"


def _term(term: Term, entry: Variable, path: str, adapter: Adapter) -> Iterator[str]:
    if term.height != 1:
        adapter.cannot(f"the height {term.height:g}", path, "height 1")
    said = shape_element(term.shape, entry)
    if said is None:
        substitute = converted(term.shape, "trapezoid")
        said = shape_element(substitute, entry)
        assert said is not None, "every trapezoid can be said"
        adapter.cannot(f"the shape '{kind(term.shape)}'", path, "a trapezoid")
    complement = "true" if term.complement else "false"
    yield f'      <fuzzyTerm name={quoted_name(term.name, path, adapter)} complement="{complement}">'
    yield f"        {said}"
    yield "      </fuzzyTerm>"


def _rule_base(
    base: str, attributes: str, methods: str, rules: Sequence[Rule], system: FuzzySystem, adapter: Adapter
) -> Iterator[str]:
    tags = words.RULE_BASES[base]
    yield f'  <{base} name="{base}" {attributes}>'
    for number, rule in enumerate(rules, 1):
        yield from _rule(rule, f"{tags.rule}{number}", methods, tags, system, adapter)
    yield f"  </{base}>"


def _rule(
    rule: Rule, name: str, methods: str, tags: words.RuleTags, system: FuzzySystem, adapter: Adapter
) -> Iterator[str]:
    path = f"the rule '{format_rule(rule)}'"
    chain = literals.chain(rule.antecedent)
    if chain is None:
        raise InvalidSystemError(f"{adapter.title} cannot say {path}: it joins propositions by AND alone or OR alone")
    connector = "or" if chain.is_or else "and"
    weight = digits(rule.weight)
    yield f'    <{tags.rule} name="{name}" {methods} connector="{connector}" weight="{weight}">'
    yield "      <antecedent>"
    inputs = {entry.name for entry in system.inputs}
    for literal in chain.literals:
        if literal.proposition.variable not in inputs:
            message = f"{adapter.title} cannot say {path}: '{literal.proposition.variable}' is an output"
            raise InvalidSystemError(message)
        yield _clause("clause", literal.proposition, _modifier(literal, path, adapter), adapter)
    yield "      </antecedent>"
    yield f"      <{tags.consequent}><{tags.then}>"
    for consequent in rule.consequents:
        yield _clause(tags.clause, consequent, "", adapter)
    yield f"      </{tags.then}></{tags.consequent}>"
    yield f"    </{tags.rule}>"


def _modifier(literal: literals.Literal, path: str, adapter: Adapter) -> str:
    modifiers = [*literal.hedges, *(["not"] if literal.is_negated else [])]
    if len(modifiers) > 1:
        said = " ".join(reversed(modifiers))
        raise InvalidSystemError(f"{adapter.title} cannot say '{said}' in {path}: a clause has one modifier")
    return f' modifier="{modifiers[0]}"' if modifiers else ""


def _clause(tag: str, proposition: Is, modifier: str, adapter: Adapter) -> str:
    variable = escape(plain_name(proposition.variable, "rules", adapter))
    term = escape(plain_name(proposition.term, "rules", adapter))
    return f"        <{tag}{modifier}><variable>{variable}</variable><term>{term}</term></{tag}>"
