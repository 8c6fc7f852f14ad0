"""Operators that do not go together, or with the sets, as their names let one expect; rules that build on no other."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from fuzzy import sets
from fuzzy.compiler.methods import SETLESS
from fuzzy.finding import Finding
from fuzzy.rules import all_rules, propositions
from fuzzy.system import FuzzySystem, Is, Output, Term


def consistency(system: FuzzySystem) -> Iterator[Finding]:
    """Find operators that do not go together or with the sets, and rules that build on no other."""
    yield from _chained(system)
    inference = system.inference
    implication, aggregation = inference.implication, inference.aggregation
    is_weighted = inference.defuzzifier in SETLESS
    if is_weighted:
        yield from _shared_terms(system)
        return
    if implication == "drastic_product":
        for output in system.outputs:
            peaked = [f"'{term.name}'" for term in output.terms if not _has_plateau(term, output)]
            if peaked:
                message = (
                    f"{', '.join(peaked)} of '{output.name}' are 1 at single points at most: under the drastic product "
                    "nothing with an area is left of them where a rule fires below 1"
                )
                yield Finding("warning", message, "inference.implication")
    if (implication == "kleene_dienes") != (aggregation == "min"):
        message = (
            "kleene_dienes is large where a rule says nothing: joined by anything but min it hides the other rules"
            if implication == "kleene_dienes"
            else f"min keeps what all rules imply: with the implication {implication} that is 0 nearly everywhere"
        )
        yield Finding("warning", message, "inference.aggregation")
    if implication in {"bounded_sum", "algebraic_sum"}:
        message = f"the {implication} lifts the whole universe by the firing strength: outputs are drawn to mid-range"
        yield Finding("hint", message, "inference.implication")


def _has_plateau(term: Term, output: Output) -> bool:
    left, right = sets.core(term, output.low, output.high)
    top = sets.degrees(term, 0.5 * (left + right))
    return bool(top >= 1.0 and right - left > 1e-9 * (output.high - output.low))


def _shared_terms(system: FuzzySystem) -> Iterator[Finding]:
    """Find terms that several rules of a weighted system conclude, of which only the strongest counts."""
    if system.inference.aggregation != "max" or system.inference.defuzzifier == "height":
        return
    counts = Counter(consequent for rule in all_rules(system) for consequent in set(rule.consequents))
    shared = [consequent for consequent, count in counts.items() if count > 1]
    if shared:
        example = f"'{shared[0].variable} is {shared[0].term}' of {counts[shared[0]]} rules"
        message = f"under max {example} counts once, at its strongest; under sum every rule does, as Sugeno has it"
        yield Finding("hint", message, "inference.aggregation")


def _chained(system: FuzzySystem) -> Iterator[Finding]:
    """Find antecedents that name an output term which no rule before concludes."""
    outputs = {output.name for output in system.outputs}
    rules = all_rules(system)
    offset = len(rules) - len(system.rules.list)
    concluded: set[Is] = set()
    for number, rule in enumerate(rules):
        for proposition in propositions(rule.antecedent):
            if proposition.variable in outputs and proposition not in concluded:
                message = (
                    f"no rule before concludes '{proposition.variable} is {proposition.term}': its degree is 0 here"
                )
                yield Finding("warning", message, f"rules.list[{number - offset}]")
        concluded.update(rule.consequents)
