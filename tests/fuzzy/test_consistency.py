"""Findings on operators and on rules that build on others."""

from __future__ import annotations

import pytest
from msgspec.structs import replace

from fuzzy import check, load
from fuzzy.operators import COMPOSITIONS
from fuzzy.shapes import Singleton
from fuzzy.system import Inference, Is, Rule, RuleBase, Term

DIAGONAL = load("rulebases/diagonal.yaml")


def messages(**operators) -> list[tuple[str, str, str]]:
    found = check(replace(DIAGONAL, inference=Inference(**operators)))
    return [(finding.level, finding.path, finding.message) for finding in found]


@pytest.mark.parametrize("name", ["Max-Min", "Sum-Min", "Max-Product", "Sum-Product", "Max-Bounded product", "Min-Max"])
def test_compositions_that_do_what_they_say_are_not_remarked_on(name):
    composition = COMPOSITIONS[name]
    assert messages(implication=composition.implication, aggregation=composition.aggregation) == []


@pytest.mark.parametrize(
    ("operators", "level", "path", "message"),
    [
        ({"implication": "drastic_product"}, "warning", "inference.implication", "1 at single points at most"),
        ({"implication": "kleene_dienes"}, "warning", "inference.aggregation", "joined by anything but min it hides"),
        ({"aggregation": "min"}, "warning", "inference.aggregation", "min keeps what all rules imply"),
        ({"implication": "bounded_sum"}, "hint", "inference.implication", "drawn to mid-range"),
        ({"implication": "algebraic_sum"}, "hint", "inference.implication", "drawn to mid-range"),
    ],
)
def test_pairs_that_mislead_are_named(operators, level, path, message):
    (found,) = messages(**operators)
    assert found[:2] == (level, path)
    assert message in found[2]


def test_under_max_a_sugeno_system_is_told_that_rules_share_terms():
    output = DIAGONAL.outputs[0]
    terms = tuple(Term(term.name, Singleton(float(n))) for n, term in enumerate(output.terms))
    inference = Inference(defuzzifier="weighted_average")
    sugeno = replace(DIAGONAL, outputs=(replace(output, terms=terms),), inference=inference)
    (found,) = check(sugeno)
    assert "under sum every rule does, as Sugeno has it" in found.message
    assert check(replace(sugeno, inference=replace(inference, aggregation="sum"))) == []


def test_an_output_that_no_rule_before_concludes_is_named():
    rules = (
        Rule(Is("T", "LL"), (Is("T", "LR"),)),  # the table concludes LL
        Rule(Is("e", "NB"), (Is("T", "Z"),)),
    )
    bare = replace(DIAGONAL, rules=RuleBase(None, rules))
    found = [finding for finding in check(bare) if "no rule before" in finding.message]
    assert [finding.path for finding in found] == ["rules.list[0]"]
    chained = replace(DIAGONAL, rules=replace(DIAGONAL.rules, list=rules))
    assert not [finding for finding in check(chained) if "no rule before" in finding.message]
