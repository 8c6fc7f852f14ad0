"""Every rule of a valid document: generated systems pass, and each single mistake is named with its path."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from fuzzy import sets
from fuzzy.errors import InvalidSystemError
from fuzzy.shapes import Gaussian, Trapezoid, Triangle
from fuzzy.system import (
    And,
    FuzzySystem,
    Inference,
    Input,
    Is,
    NoFire,
    Not,
    Output,
    Rule,
    RuleBase,
    RuleTable,
    Sampling,
    Term,
)
from fuzzy.validation import validate
from tests import plain, strategies

FULL = Triangle(-1.0, 0.0, 1.0)
E = Input("e", -1.0, 1.0, (Term("N", FULL), Term("P", FULL)))
DE = Input("de", -6.0, 6.0, (Term("N", FULL), Term("P", FULL)))
T = Output("T", -85.0, 85.0, (Term("L", FULL), Term("R", FULL)))
TABLE = RuleTable("e", "de", "T", (("L", "R"), ("R", None)))
RULE = Rule(Is("e", "N"), (Is("T", "L"),))
SYSTEM = FuzzySystem("s", (E, DE), (T,), RuleBase(TABLE, (RULE,)))
ANYTHING: Any = object()


def _with_input(**changes: Any) -> FuzzySystem:
    return replace(SYSTEM, inputs=(replace(E, **changes), DE))


def _with_output(**changes: Any) -> FuzzySystem:
    return replace(SYSTEM, outputs=(replace(T, **changes),))


def _with_table(**changes: Any) -> FuzzySystem:
    return replace(SYSTEM, rules=RuleBase(replace(TABLE, **changes)))


def _with_rule(**changes: Any) -> FuzzySystem:
    return replace(SYSTEM, rules=RuleBase(None, (replace(RULE, **changes),)))


def _deep(levels: int) -> Any:
    expression: Any = Is("e", "N")
    for _ in range(levels):
        expression = Not(expression)
    return expression


@given(strategies.systems(name=strategies.names))
@settings(max_examples=60)
def test_generated_systems_are_valid_and_come_back_equal(system):
    assert validate(system) == system


def test_numbers_become_floats_and_sequences_tuples():
    loose: Any = [Term("N", Triangle(-1, 0, 1)), Term("P", Triangle(-1, np.float64(0), 1))]
    system = validate(_with_input(low=-1, high=np.float64(1), terms=loose))
    assert system == SYSTEM
    assert type(system.inputs[0].low) is float
    assert type(system.inputs[0].high) is float
    assert type(system.inputs[0].terms) is tuple


@pytest.mark.parametrize(
    ("system", "path", "message"),
    [
        (replace(SYSTEM, name=""), "name", "the system's name is empty"),
        (replace(SYSTEM, name=ANYTHING), "", "the document holds"),
        (replace(SYSTEM, name=5), "name", "Expected `str`, got `int`"),
        (replace(SYSTEM, name="a\nb"), "name", "cannot be printed"),
        (replace(SYSTEM, name=" s"), "name", "begins or ends with a blank"),
        (replace(SYSTEM, name="\ud800"), "name", ""),
        (replace(SYSTEM, notes="\x00"), "notes", "holds the character"),
        (replace(SYSTEM, notes="x" * 30_000), "notes", "30000 characters: at most 20000"),
        (replace(SYSTEM, inputs=()), "inputs", "0 inputs: valid are 1 to 16"),
        (replace(SYSTEM, outputs=()), "outputs", "0 outputs: valid are 1 to 16"),
        (replace(SYSTEM, inputs=tuple(replace(E, name=f"e{i}") for i in range(17))), "inputs", "17 inputs"),
        (_with_input(name="T"), "outputs.T", "the name 'T' is used twice"),
        (_with_input(name="x" * 65), f"inputs.{'x' * 65}", "65 characters: at most 64"),
        (_with_input(low=1.0), "inputs.e.range", "[1, 1]: valid is low < high"),
        (_with_input(low=math.nan), "inputs.e.range", "[nan, 1]: valid is low < high"),
        (_with_input(high=math.inf), "inputs.e.range", "[-1, inf]: valid is low < high"),
        (_with_input(high=2e12), "inputs.e.range", "at most 1e+12"),
        (_with_input(low=1e6, high=1e6 + 1e-6), "inputs.e.range", "too narrow"),
        (_with_input(low=0, high=1e-300), "inputs.e.range", "too narrow"),
        (_with_input(low="0"), "inputs[0].low", "Expected `float`, got `str`"),
        (_with_input(low=True), "inputs[0].low", "Expected `float`, got `bool`"),
        (_with_input(unit="\n"), "inputs.e.unit", "printable"),
        (_with_input(out_of_range="wrap"), "inputs[0].out_of_range", "Invalid enum value 'wrap'"),
        (_with_input(terms=()), "inputs.e.terms", "0 terms: valid are 1 to 64"),
        (_with_input(terms=(Term("N", FULL), Term("N", FULL))), "inputs.e.terms.N", "the name 'N' is used twice"),
        (_with_input(terms=(Term("", FULL),)), "inputs.e.terms.", "a term's name is empty"),
        (_with_input(terms=(Term("N", Triangle(0, -1, 1)),)), "inputs.e.terms.N", "is not in order"),
        (_with_input(terms=(Term("N", Triangle(0, math.nan, 1)),)), "inputs.e.terms.N", "not a number"),
        (_with_input(terms=(Term("N", Gaussian(0, 0)),)), "inputs.e.terms.N", "sigma"),
        (_with_input(terms=(Term("N", Triangle(-1e13, 0, 1)),)), "inputs.e.terms.N", "beyond 1e+12"),
        (_with_input(terms=(Term("N", ANYTHING),)), "", "the document holds"),
        (_with_output(terms=(Term("L", Triangle(90, 95, 99)),)), "outputs.T.terms.L", "no area in [-85, 85]"),
        (_with_output(terms=(Term("L", Triangle(5, 5, 5)),)), "outputs.T.terms.L", "no area in [-85, 85]"),
        (_with_output(terms=(Term("L", Gaussian(900, 1)),)), "outputs.T.terms.L", "no area in [-85, 85]"),
        (_with_output(no_fire=NoFire("default", math.inf)), "outputs.T.no_fire", "default inf: valid is a finite"),
        (_with_output(no_fire=NoFire("default", math.nan)), "outputs.T.no_fire", "default nan: valid is a finite"),
        (
            _with_output(no_fire=NoFire("hold", 1)),
            "outputs.T.no_fire",
            "belongs to the policy 'default', not to 'hold'",
        ),
        (_with_table(rows="x"), "rules.table.rows", "unknown variable 'x'; valid: e, de"),
        (_with_table(columns="T"), "rules.table.columns", "unknown variable 'T'; valid: e, de"),
        (_with_table(output="e"), "rules.table.output", "unknown variable 'e'; valid: T"),
        (_with_table(columns="e"), "rules.table.columns", "rows and columns are the same input 'e'"),
        (_with_table(cells=(("L", "R"),)), "rules.table.cells", "1 rows: 'e' has 2 terms"),
        (_with_table(cells=(("L",), ("L", "R"))), "rules.table.cells.N", "1 cells: 'de' has 2 terms: N, P"),
        (_with_table(cells=(("L", "LL"), ("L", "R"))), "rules.table.cells.N[1]", "did you mean 'L'? valid: L, R"),
        (_with_rule(weight=1.5), "rules.list[0]", "weight 1.5: valid is 0 to 1"),
        (_with_rule(weight=math.nan), "rules.list[0]", "weight nan: valid is 0 to 1"),
        (_with_rule(antecedent=Is("Q", "L")), "rules.list[0]", "unknown input 'Q'; valid: e, de"),
        (_with_rule(antecedent=Is("e", "Q")), "rules.list[0]", "unknown term of 'e': 'Q'; valid: N, P"),
        (_with_rule(antecedent=And((Is("e", "N"),))), "rules.list[0]", "at least two expressions, found 1"),
        (_with_rule(antecedent=_deep(17)), "rules.list[0]", "nested more than 16 deep"),
        (_with_rule(antecedent=_deep(50_000)), "", "the document holds"),
        (_with_rule(antecedent=And((Is("e", "N"),) * 65)), "rules.list[0]", "65 propositions in the antecedent"),
        (_with_rule(consequents=()), "rules.list[0]", "0 consequents: valid are 1 to 64"),
        (_with_rule(consequents=(Is("e", "N"),)), "rules.list[0]", "unknown output 'e'; valid: T"),
        (_with_rule(consequents=RULE.consequents * 2), "rules.list[0]", "stands twice"),
        (replace(SYSTEM, rules=RuleBase(None, (RULE,) * 4097)), "rules", "4097 rules: at most 4096"),
        (replace(SYSTEM, inference=Inference(resolution=Sampling(1))), "inference.resolution.points", "2 to 100000"),
        (replace(SYSTEM, inference=Inference(conjunction=ANYTHING)), "", "the document holds"),
        (ANYTHING, "", "expected a FuzzySystem, found object"),
    ],
)
def test_each_mistake_is_named_with_its_place(system, path, message):
    with pytest.raises(InvalidSystemError) as caught:
        validate(system)
    assert (caught.value.path, message in caught.value.message) == (path, True), caught.value


def test_an_input_may_hold_a_singleton_or_a_set_outside_its_range():
    terms = (Term("N", Triangle(0, 0, 0)), Term("P", Trapezoid(5, 6, 7, 8)))
    assert validate(_with_input(terms=terms)).inputs[0].terms == terms


@given(strategies.systems())
@settings(max_examples=40)
def test_support_bounds_where_a_set_is_positive(system):
    for variable in (*system.inputs, *system.outputs):
        x = np.linspace(variable.low, variable.high, 101)
        for term in variable.terms:
            left, right = sets.support(term, variable.low, variable.high)
            outside = (x < left) | (x > right)
            assert np.all(plain.degrees(term.shape, x[outside]) <= 1.3e-14)


@given(strategies.systems(name=strategies.names), st.data())
def test_what_was_found_valid_before_is_not_trusted_in_what_changed(system, data):
    known = validate(system)
    assert validate(known) == known
    assert validate(known).inputs is known.inputs
    wrong = data.draw(
        st.sampled_from(
            [
                replace(known, name=""),
                replace(known, name=7),
                replace(known, notes="\x00"),
                replace(known, rules=RuleBase(RuleTable("?", "?", "?", ((None,),)), known.rules.list)),
                replace(known, rules=RuleBase(RuleTable("e", "de", "T", 3), known.rules.list)),  # type: ignore[arg-type]
            ]
        )
    )
    with pytest.raises(InvalidSystemError):
        validate(wrong)
