"""Variables that come and go, and systems to begin with: valid, runnable, and the rules that stay mean the same."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

import fuzzy
from fuzzy import edits
from fuzzy.errors import InvalidSystemError
from fuzzy.formats import dumps, load, loads
from fuzzy.language import parse_rule
from fuzzy.rules import all_rules, propositions
from fuzzy.shapes import Linear, Singleton
from fuzzy.system import FuzzySystem, Input
from fuzzy.validation import validate
from tests import strategies

DIAGONAL = load(Path(__file__).parents[2] / "rulebases" / "diagonal.yaml")


def names(system: FuzzySystem) -> list[str]:
    return [variable.name for variable in (*system.inputs, *system.outputs)]


@pytest.mark.parametrize("terms", [2, 3, 4, 5, 6, 7, 9])
def test_an_empty_table_runs_and_a_filled_one_is_the_shipped_controller(terms: int) -> None:
    system = edits.empty_table(terms)
    assert all_rules(system) == ()
    assert loads(dumps(system)) == system
    controller = fuzzy.compile_system(system)
    assert controller(0.3, -1.0) == 0.0
    assert [(v.low, v.high) for v in (*system.inputs, *system.outputs)] == [(-1, 1), (-6, 6), (-85, 85)]
    filled = fuzzy.compile_system(edits.fill_diagonal(system))
    corner = filled.batch([(1.0, 6.0), (-1.0, -6.0)])[:, 0]
    if terms == 7:
        shipped = fuzzy.compile_system(DIAGONAL)
        for e, de in np.random.default_rng(0).uniform((-1, -6), (1, 6), (50, 2)):
            assert filled(e, de) == pytest.approx(shipped(e, de), abs=1e-9)
    assert corner[0] == pytest.approx(-corner[1])


@pytest.mark.parametrize("terms", [0, 1, 8, 64, -3])
def test_a_table_of_a_size_without_usual_names_is_refused(terms: int) -> None:
    with pytest.raises(InvalidSystemError, match="valid are 2, 3, 4, 5, 6, 7, 9"):
        edits.empty_table(terms)


@given(strategies.systems(max_rules=3), st.booleans())
@settings(max_examples=50)
def test_what_was_added_changes_no_rule_and_removing_it_gives_the_system_back(
    system: FuzzySystem, is_input: bool
) -> None:
    if "added" in names(system):
        return
    add = edits.add_input if is_input else edits.add_output
    grown = add(system, "added")
    assert all_rules(grown) == all_rules(system)
    assert loads(dumps(grown)) == grown
    assert edits.remove_variable(grown, "added") == system
    with pytest.raises(InvalidSystemError, match="is used already"):
        add(grown, "added")


@given(st.data())
@settings(max_examples=50)
def test_the_rules_that_name_a_removed_variable_go_with_it(data: st.DataObject) -> None:
    system = data.draw(strategies.systems(max_rules=3))
    variable = data.draw(st.sampled_from((*system.inputs, *system.outputs)))
    siblings = system.inputs if isinstance(variable, Input) else system.outputs
    if len(siblings) == 1:
        with pytest.raises(InvalidSystemError, match="is the only"):
            edits.remove_variable(system, variable.name)
        return
    smaller = edits.remove_variable(system, variable.name)
    assert names(smaller) == [name for name in names(system) if name != variable.name]
    for rule in all_rules(smaller):
        named = {one.variable for one in (*propositions(rule.antecedent), *rule.consequents)}
        assert variable.name not in named


def test_a_table_goes_with_its_variable_and_a_listed_rule_keeps_its_other_consequent() -> None:
    system = edits.add_output(edits.add_input(DIAGONAL, "x"), "y")
    rule = parse_rule("if e is NB then T is LL, y is P", system)
    system = edits.add_rule(system, rule)
    without = edits.remove_variable(system, "T")
    assert without.rules.table is None
    assert [one.consequents for one in without.rules.list] == [rule.consequents[1:]]
    assert edits.remove_variable(system, "x").rules == system.rules


def test_linear_terms_keep_one_coefficient_for_each_input() -> None:
    output = DIAGONAL.outputs[0]
    terms = tuple(replace(term, shape=Linear((1.0, 2.0), 3.0)) for term in output.terms)
    inference = replace(DIAGONAL.inference, defuzzifier="weighted_average")
    sugeno = validate(replace(DIAGONAL, outputs=(replace(output, terms=terms),), inference=inference))
    grown = edits.add_input(sugeno, "x")
    assert grown.outputs[0].terms[0].shape == Linear((1.0, 2.0, 0.0), 3.0)
    assert edits.remove_variable(grown, "e").outputs[0].terms[0].shape == Linear((2.0, 0.0), 3.0)
    added = edits.add_output(grown, "y").outputs[1]
    assert all(isinstance(term.shape, Singleton) for term in added.terms)
