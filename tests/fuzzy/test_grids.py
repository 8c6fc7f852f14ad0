"""Rules as a grid: what is painted is what is there, in a table and in a list alike; tables and lists say the same."""

import itertools
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

import fuzzy
from fuzzy import edits, patterns
from fuzzy.edits import Grid
from fuzzy.errors import InvalidSystemError
from fuzzy.formats import load
from fuzzy.language import parse_rule
from fuzzy.rules import all_rules
from fuzzy.shapes import Triangle
from fuzzy.system import FuzzySystem, Input, Is, RuleBase, Term
from tests import strategies

RULEBASES = Path(__file__).parents[2] / "rulebases"
DIAGONAL = load(RULEBASES / "diagonal.yaml")
PILTAN = load(RULEBASES / "piltan.yaml")
LISTED = edits.dissolve_table(PILTAN)
GRID = Grid("e", "de", "T")


def three_inputs(*rules: str) -> FuzzySystem:
    third = Input("x", 0.0, 1.0, (Term("low", Triangle(-1, 0, 1)), Term("high", Triangle(0, 1, 2))))
    system = replace(DIAGONAL, inputs=(*DIAGONAL.inputs, third), rules=RuleBase())
    return replace(system, rules=RuleBase(None, tuple(parse_rule(text, system) for text in rules)))


@st.composite
def grids(draw: st.DrawFn, system: FuzzySystem) -> Grid:
    inputs = draw(st.permutations(system.inputs))
    rows, columns, *others = inputs
    said = draw(st.lists(st.sampled_from(others), unique_by=lambda v: v.name)) if others else []
    chosen = tuple(Is(one.name, draw(st.sampled_from(one.terms)).name) for one in said)
    return Grid(rows.name, columns.name, draw(st.sampled_from(system.outputs)).name, chosen)


@given(strategies.systems(max_rules=4), st.data())
@settings(max_examples=60)
def test_what_is_painted_is_what_is_there_and_nothing_else_changes(system, data):
    assume(len(system.inputs) >= 2)
    grid = data.draw(grids(system))
    cells = edits.grid_cells(system, grid)
    i = data.draw(st.integers(0, len(cells) - 1))
    j = data.draw(st.integers(0, len(cells[0]) - 1))
    output = next(entry for entry in system.outputs if entry.name == grid.output)
    term = data.draw(st.sampled_from([None, *(term.name for term in output.terms)]))
    painted = edits.set_cell(system, i, j, term, grid)
    expected = [list(row) for row in cells]
    expected[i][j] = term
    assert [list(row) for row in edits.grid_cells(painted, grid)] == expected
    number = edits.grid_rule_numbers(painted, grid)[i][j]
    assert (number < 0) == (term is None)
    if term is not None:
        assert Is(grid.output, term) in all_rules(painted)[number].consequents
    if cells[i][j] is None:
        assert edits.set_cell(painted, i, j, None, grid) == system


@given(strategies.systems(max_rules=4), st.data())
@settings(max_examples=40)
def test_every_cell_belongs_to_the_rule_of_its_number(system, data):
    assume(len(system.inputs) >= 2)
    grid = data.draw(grids(system))
    rules = all_rules(system)
    for row, numbers in zip(edits.grid_cells(system, grid), edits.grid_rule_numbers(system, grid), strict=True):
        for cell, number in zip(row, numbers, strict=True):
            assert (cell is None) == (number < 0)
            assert cell is None or Is(grid.output, cell) in rules[number].consequents


def test_a_table_and_its_list_are_the_same_controller_and_become_each_other():
    assert LISTED.rules.table is None
    assert all_rules(LISTED) == all_rules(PILTAN)
    x = np.array(list(itertools.product(np.linspace(-1, 1, 9), np.linspace(-6, 6, 9))))
    assert np.array_equal(fuzzy.compile_system(LISTED).batch(x), fuzzy.compile_system(PILTAN).batch(x))
    assert edits.default_grid(LISTED) == GRID
    assert edits.grid_cells(LISTED, GRID) == edits.rule_table(PILTAN).cells
    assert edits.give_table(LISTED, GRID) == PILTAN


def test_a_turned_grid_shows_the_table_turned():
    turned = Grid("de", "e", "T")
    assert edits.is_table(PILTAN, turned)
    assert edits.grid_cells(PILTAN, turned) == tuple(zip(*edits.rule_table(PILTAN).cells, strict=True))
    painted = edits.set_cell(PILTAN, 0, 6, "LR", turned)
    assert edits.rule_table(painted).cells[6][0] == "LR"


def test_what_a_table_cannot_say_stays_in_the_list():
    system = three_inputs(
        "if de is Z and e is NB then T is LL",
        "if e is NB and de is Z then T is LR",
        "if e is NB and de is FL then T is ML with 0.5",
        "if e is NB and de is FR and x is low then T is ML",
        "if e is Z or de is Z then T is Z",
    )
    tabled = edits.give_table(system, GRID)
    assert edits.rule_table(tabled).cells[0] == (None, None, None, "LL", None, None, None)
    assert tabled.rules.list == system.rules.list[1:]


def test_a_slice_shows_and_paints_the_rules_that_name_it():
    system = three_inputs(
        "if e is NB and de is FL and x is low then T is LL with 0.5",
        "if x is high and e is NB and de is FL then T is LR",
        "if e is Z and de is Z then T is Z",
    )
    low, high = (Grid("e", "de", "T", (Is("x", term),)) for term in ("low", "high"))
    assert edits.default_grid(system) == low
    assert edits.grid_cells(system, low)[0][0] == "LL"
    assert edits.grid_cells(system, high)[0][0] == "LR"
    assert edits.grid_cells(system, GRID)[3][3] == "Z"
    painted = edits.set_cell(system, 0, 0, "SL", low)
    assert painted.rules.list[0].weight == 0.5
    assert painted.rules.list[1:] == system.rules.list[1:]
    filled = edits.fill_diagonal(system, high)
    assert edits.grid_cells(filled, high) == edits.rule_table(DIAGONAL).cells
    assert edits.grid_cells(filled, low) == edits.grid_cells(system, low)
    assert edits.clear_table(edits.clear_table(edits.clear_table(filled, low), high), GRID).rules == RuleBase()


def test_a_grid_survives_what_it_does_not_name():
    system = three_inputs("if e is NB and de is FL and x is low then T is LL")
    low = Grid("e", "de", "T", (Is("x", "low"),))
    assert edits.fitting_grid(system, low) == low
    assert edits.fitting_grid(edits.rename_term(system, "x", "low", "none"), low) == GRID
    assert edits.fitting_grid(edits.rename_variable(system, "e", "error"), low) == Grid(
        "error", "de", "T", (Is("x", "low"),)
    )
    assert edits.fitting_grid(system, Grid("e", "e", "T")) == low
    assert edits.fitting_grid(replace(DIAGONAL, inputs=DIAGONAL.inputs[:1], rules=RuleBase()), low) is None


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (lambda: edits.give_table(PILTAN, GRID), "there is a rule table already"),
        (lambda: edits.dissolve_table(LISTED), "has no rule table"),
        (lambda: edits.set_cell(LISTED, 0, 0, "Z"), "has no rule table"),
        (lambda: edits.set_cell(LISTED, 0, 0, "XX", GRID), "unknown term of 'T': 'XX'"),
        (lambda: edits.set_cell(LISTED, 0, 0, "Z", Grid("e", "T", "de")), "a grid has two inputs"),
        (lambda: edits.set_grid_cells(LISTED, GRID, ((None,),)), "expected 7 rows of 7 cells"),
        (lambda: edits.fill_linear(PILTAN, float("nan"), 0.0), "valid are finite numbers"),
    ],
)
def test_what_cannot_be_says_why(edit, message):
    with pytest.raises(InvalidSystemError) as caught:
        edit()
    assert message in str(caught.value)


# The list


@given(strategies.systems(max_rules=4), st.data())
@settings(max_examples=40)
def test_edits_of_the_list_are_undone_by_their_opposites(system, data):
    rule = data.draw(strategies.rules_of(system.inputs, system.outputs))
    place = data.draw(st.integers(0, len(system.rules.list)))
    added = edits.add_rule(system, rule, place)
    assert added.rules.list[place] == rule
    assert edits.remove_rule(added, place) == system
    other = data.draw(strategies.rules_of(system.inputs, system.outputs))
    assert edits.set_rule(edits.set_rule(added, place, other), place, rule) == added
    assert edits.set_weight(added, place, 0.25).rules.list[place] == replace(rule, weight=0.25)


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (lambda: edits.remove_rule(LISTED, 49), "rules.list: no rule 50: the list has 49"),
        (lambda: edits.set_weight(LISTED, 0, 1.5), "rules.list[0]: weight 1.5: valid is 0 to 1"),
        (lambda: edits.add_rule(LISTED, LISTED.rules.list[0], -1), "place -1: valid are 0 to 49"),
    ],
)
def test_a_rule_that_cannot_be_is_refused(edit, message):
    with pytest.raises(InvalidSystemError) as caught:
        edit()
    assert message in str(caught.value)


# The linear law


@given(st.floats(-200, 200), st.floats(-40, 40))
@settings(max_examples=60)
def test_a_linear_law_gives_the_nearest_terms_antisymmetrically(kp, kd):
    filled = edits.fill_linear(DIAGONAL, kp, kd)
    names: list[str | None] = [term.name for term in DIAGONAL.outputs[0].terms]
    cells = edits.rule_table(filled).cells
    places = [-85 + 170 / 6 * n for n in range(7)]
    for i, j in itertools.product(range(7), range(7)):
        wanted = kp * (i - 3) / 3 + kd * (j - 3) * 2
        assert abs(places[names.index(cells[i][j])] - wanted) == pytest.approx(
            min(abs(place - wanted) for place in places), abs=0.2
        )
        assert names.index(cells[6 - i][6 - j]) == 6 - names.index(cells[i][j])


def test_the_gains_of_the_diagonal_give_the_diagonal():
    gains = edits.full_gains(DIAGONAL)
    assert gains == pytest.approx((85.0, 85 / 6))
    assert edits.fill_linear(edits.clear_table(DIAGONAL), *gains) == DIAGONAL
    assert edits.rule_table(edits.fill_linear(PILTAN, 0, 0)).cells == (("Z",) * 7,) * 7


def test_a_pattern_needs_no_table_of_the_document():
    assert patterns.linear([0.0], [0.0, 1.0], [0.0, 10.0], ["off", "on"], 1.0, 10.0) == (("off", "on"),)
