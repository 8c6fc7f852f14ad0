"""Edits: inverses restore the system, renaming keeps the meaning, partitions stay partitions, errors say why."""

import itertools
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from fuzzy import edits, patterns
from fuzzy.errors import InvalidSystemError
from fuzzy.formats import load
from fuzzy.language import format_rule, parse_rule
from fuzzy.rules import all_rules, propositions
from fuzzy.shapes import Gaussian, Shape, Trapezoid, Triangle, parameter_names, parameters
from fuzzy.system import FuzzySystem, Input, Is, NoFire, Output, RuleBase, Sampling, Term
from fuzzy.validation import validate
from tests import plain, strategies

RULEBASES = Path(__file__).parents[2] / "rulebases"
DIAGONAL = load(RULEBASES / "diagonal.yaml")
PILTAN = load(RULEBASES / "piltan.yaml")


def _variable(system: FuzzySystem, name: str) -> Input | Output:
    return next(entry for entry in (*system.inputs, *system.outputs) if entry.name == name)


def _shape(system: FuzzySystem, variable: str, term: str) -> Shape:
    return next(entry.shape for entry in _variable(system, variable).terms if entry.name == term)


@st.composite
def _system_and_term(draw: st.DrawFn) -> tuple[FuzzySystem, str, str]:
    system = draw(strategies.systems(max_rules=3))
    variable = draw(st.sampled_from((*system.inputs, *system.outputs)))
    return system, variable.name, draw(st.sampled_from(variable.terms)).name


# The rule table


@given(st.integers(0, 6), st.integers(0, 6), st.sampled_from([None, "LL", "Z", "MR"]))
@settings(max_examples=30)
def test_painting_a_cell_changes_that_cell_alone_and_is_undone_by_painting_back(row, column, term):
    table = edits.rule_table(PILTAN)
    painted = edits.set_cell(PILTAN, row, column, term)
    changed = edits.rule_table(painted).cells
    assert changed[row][column] == term
    assert sum(a != b for x, y in zip(changed, table.cells, strict=True) for a, b in zip(x, y, strict=True)) <= 1
    rows, columns = PILTAN.inputs[0].terms, PILTAN.inputs[1].terms
    assert edits.set_cell(painted, rows[row].name, columns[column].name, table.cells[row][column]) == PILTAN


def test_fills_give_the_shipped_tables():
    assert edits.fill_diagonal(PILTAN).rules == DIAGONAL.rules
    assert edits.fill_piltan(edits.clear_table(DIAGONAL)).rules == PILTAN.rules
    assert all_rules(edits.clear_table(DIAGONAL)) == ()


@given(st.integers(1, 9), st.integers(1, 9), st.integers(0, 4).map(lambda half: 2 * half + 1))
def test_diagonal_is_monotone_and_antisymmetric_at_any_size(rows, columns, count):
    terms = [str(number) for number in range(count)]
    cells = np.array(patterns.diagonal(rows, columns, terms)).astype(int)
    assert np.all(np.diff(cells, axis=0) >= 0)
    assert np.all(np.diff(cells, axis=1) >= 0)
    assert np.array_equal(cells, count - 1 - cells[::-1, ::-1])


@given(st.data())
def test_mirroring_keeps_the_first_half_and_is_antisymmetric(data):
    terms = ["L", "Z", "R"]
    rows, columns = data.draw(st.integers(1, 5)), data.draw(st.integers(1, 5))
    cells = tuple(tuple(data.draw(st.sampled_from([None, *terms])) for _ in range(columns)) for _ in range(rows))
    mirrored = patterns.mirrored(cells, terms)
    flat, first = [cell for row in mirrored for cell in row], [cell for row in cells for cell in row]
    opposite = {"L": "R", "Z": "Z", "R": "L", None: None}
    assert flat[: len(flat) // 2] == first[: len(flat) // 2]
    assert flat == [opposite[cell] for cell in reversed(flat)]
    assert patterns.mirrored(mirrored, terms) == mirrored


def test_fills_that_do_not_fit_say_so():
    small = edits.remove_term(DIAGONAL, "e", "NB")
    with pytest.raises(InvalidSystemError, match="piltan is a table of 7 by 7 cells with 7 terms: found 6 by 7 with 7"):
        edits.fill_piltan(small)
    without = replace(DIAGONAL, rules=RuleBase())
    for edit in (edits.fill_diagonal, edits.fill_piltan, edits.mirror_antisymmetrically, edits.clear_table):
        with pytest.raises(InvalidSystemError, match="has no rule table"):
            edit(without)


# Sets


def _assert_partition(system: FuzzySystem, variable: str) -> None:
    found = _variable(system, variable)
    x = np.linspace(found.low, found.high, 1001)
    assert np.sum([plain.degrees(term.shape, x) for term in found.terms], axis=0) == pytest.approx(1, abs=1e-12)


MIXED = replace(
    DIAGONAL,
    inputs=(
        Input(
            "e",
            -1,
            1,
            (
                Term("low", Trapezoid(-math.inf, -1, -0.8, -0.4)),
                Term("high", Trapezoid(0.3, 0.5, 1, math.inf)),
                Term("middle", Trapezoid(-0.8, -0.4, 0.1, 0.3)),
                Term("peak", Triangle(0.1, 0.3, 0.5)),
            ),
        ),
    ),
    rules=RuleBase(),
)
"""A partition of both shapes, its terms not in the order of their sets."""


@given(st.sampled_from([DIAGONAL, MIXED]), st.data())
@settings(max_examples=60)
def test_a_partition_stays_one_wherever_its_points_go(system, data):
    _assert_partition(system, "e")
    for _ in range(4):
        term = data.draw(st.sampled_from(system.inputs[0].terms))
        parameter = data.draw(st.sampled_from(parameter_names(term.shape)))
        old = getattr(term.shape, parameter)
        assume(math.isfinite(old))
        value = old + data.draw(st.floats(-0.4, 0.4))
        try:
            moved = edits.move_point(system, "e", term.name, parameter, value, "partition")
        except InvalidSystemError:
            continue
        assert getattr(_shape(moved, "e", term.name), parameter) == value
        _assert_partition(moved, "e")
        assert edits.move_point(moved, "e", term.name, parameter, old, "partition") == system
        system = moved


def test_a_peak_moves_the_feet_that_stand_on_it():
    moved = edits.move_point(DIAGONAL, "de", "SL", "b", -1.5, "partition")
    assert _shape(moved, "de", "ML") == Triangle(-6, -4, -1.5)
    assert _shape(moved, "de", "SL") == Triangle(-4, -1.5, 0)
    assert _shape(moved, "de", "Z") == Triangle(-1.5, 0, 2)
    by_foot = edits.move_point(DIAGONAL, "de", "Z", "a", -1.5, "partition")
    assert by_foot == moved
    outer = edits.move_point(DIAGONAL, "T", "LL", "a", -120, "partition")
    assert outer == edits.move_point(DIAGONAL, "T", "LL", "a", -120)


@pytest.mark.parametrize(
    ("variable", "term", "parameter", "value", "mode", "message"),
    [
        ("de", "SL", "b", 0.0, "partition", "0 would move 'SL' past its neighbour: valid are -4 to 0"),
        ("de", "SL", "c", -9.0, "partition", "-9 would move 'Z' past its neighbour: valid are -2 to 2"),
        ("de", "SL", "d", 0.0, "partition", "unknown parameter 'd'; valid: a, b, c"),
        ("de", "SL", "d", 0.0, "free", "unknown parameter 'd'; valid: a, b, c"),
        ("de", "SL", "b", 5.0, "free", "triangle [-4, 5, 0] is not in order: valid is a ≤ b ≤ c"),
        ("de", "SL", "b", math.nan, "free", "holds a value that is not a number"),
        ("de", "SL", "b", math.nan, "partition", "nan would move"),
        ("de", "XL", "b", 0.0, "free", "unknown term of 'de': 'XL'; valid: FL, ML"),
        ("dx", "SL", "b", 0.0, "free", "unknown variable 'dx'; valid: e, de, T"),
        ("T", "LL", "c", -90.0, "free", "is not in order"),
    ],
)
def test_a_point_that_cannot_go_there_says_why(variable, term, parameter, value, mode, message):
    with pytest.raises(InvalidSystemError) as caught:
        edits.move_point(DIAGONAL, variable, term, parameter, value, mode)
    assert message in caught.value.message


def test_a_partition_needs_shapes_with_points():
    curved = edits.set_shape(DIAGONAL, "de", "ML", Gaussian(-4, 1))
    for term, parameter in (("ML", "mean"), ("SL", "a")):
        with pytest.raises(InvalidSystemError, match="made of triangles and trapezoids: 'ML' is a gaussian"):
            edits.move_point(curved, "de", term, parameter, -3, "partition")
    assert _shape(edits.move_point(curved, "de", "ML", "sigma", 2.0), "de", "ML") == Gaussian(-4, 2)


@given(_system_and_term(), st.floats(-50, 50), st.floats(0.1, 100))
@settings(max_examples=40)
def test_scaling_a_range_keeps_every_degree(drawn, low, width):
    system, name, _ = drawn
    old = _variable(system, name)
    scaled = edits.set_range(system, name, low, low + width, scales_terms=True)
    new = _variable(scaled, name)
    assert (new.low, new.high) == (low, low + width)
    fraction = np.linspace(0, 1, 41)
    for before, after in zip(old.terms, new.terms, strict=True):
        ends = [value for value in parameters(before.shape) if math.isfinite(value)]
        steep = min((b - a for a, b in itertools.pairwise(ends) if b > a), default=old.high - old.low)
        assume(steep > 1e-3 * (old.high - old.low))
        x = old.low + (old.high - old.low) * fraction
        # A jump lies on either side of a rounded point: look beside the ends.
        away = np.min([np.abs(x - end) for end in ends], axis=0) > 1e-9 * (1 + abs(old.low) + old.high - old.low)
        x, moved = x[away], (low + width * fraction)[away]
        assert plain.degrees(after.shape, moved) == pytest.approx(plain.degrees(before.shape, x), abs=1e-7)


def test_a_default_scales_with_the_range_or_stays():
    system = edits.set_no_fire(DIAGONAL, "T", NoFire("default", 84))
    assert edits.set_range(system, "T", -83, 83).outputs[0].no_fire == NoFire("default", 84)
    scaled = edits.set_range(system, "T", -42.5, 42.5, scales_terms=True)
    assert scaled.outputs[0].no_fire == NoFire("default", 42)
    outside = edits.set_no_fire(DIAGONAL, "T", NoFire("default", 170))
    assert edits.set_range(outside, "T", -42.5, 42.5, scales_terms=True).outputs[0].no_fire == NoFire("default", 85)
    with pytest.raises(InvalidSystemError, match="valid is low < high"):
        edits.set_range(DIAGONAL, "e", 1, -1, scales_terms=True)


# Names and terms


@given(_system_and_term())
@settings(max_examples=40)
def test_renaming_keeps_the_meaning_and_is_undone(drawn):
    system, variable, term = drawn
    for renamed, back in (
        (edits.rename_term(system, variable, term, "fresh"), lambda s: edits.rename_term(s, variable, "fresh", term)),
        (edits.rename_variable(system, variable, "fresh"), lambda s: edits.rename_variable(s, "fresh", variable)),
    ):
        assert len(all_rules(renamed)) == len(all_rules(system))
        for before, after in zip(all_rules(system), all_rules(renamed), strict=True):
            pairs = zip(propositions(before.antecedent), propositions(after.antecedent), strict=True)
            for old, new in (*pairs, *zip(before.consequents, after.consequents, strict=True)):
                assert _number(system, old) == _number(renamed, new)
        assert back(renamed) == system


def _number(system: FuzzySystem, proposition: Is) -> tuple[int, int]:
    variables = [entry.name for entry in (*system.inputs, *system.outputs)]
    terms = [term.name for term in _variable(system, proposition.variable).terms]
    return variables.index(proposition.variable), terms.index(proposition.term)


def test_renaming_follows_into_rule_texts():
    rule = parse_rule("if e is NB or not (de is FL and e is Z) then T is LL", DIAGONAL)
    system = validate(replace(DIAGONAL, rules=RuleBase(None, (rule,))))
    system = edits.rename_variable(edits.rename_term(system, "e", "NB", "very big"), "e", "error")
    assert format_rule(system.rules.list[0]) == ('if error is "very big" or not (de is FL and error is Z) then T is LL')


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (lambda s: edits.rename_term(s, "e", "NB", "Z"), "inputs.e.terms.NB: 'e' has a term 'Z' already"),
        (lambda s: edits.rename_term(s, "e", "NB", ""), "a term's name is empty"),
        (lambda s: edits.rename_variable(s, "e", "T"), "inputs.e: the name 'T' is used already"),
        (lambda s: edits.set_cell(s, 7, 0, "Z"), "'e' has no term number 7: valid are 0 to 6"),
        (lambda s: edits.set_cell(s, -1, 0, "Z"), "'e' has no term number -1: valid are 0 to 6"),
        (lambda s: edits.set_cell(s, "NB", "XX", "Z"), "unknown term of 'de': 'XX'; valid: FL, ML, SL"),
        (lambda s: edits.set_cell(s, "NB", "FL", "XX"), "rules.table.cells.NB[0]: unknown term of 'T': 'XX'"),
        (lambda s: edits.add_term(s, "e", "Z", Triangle(0, 0, 1)), "the name 'Z' is used twice"),
        (lambda s: edits.add_term(s, "e", "X", Triangle(0, 0, 1), 8), "place 8: valid are 0 to 7"),
        (lambda s: edits.set_inference(s, implicaton="min"), "unknown option 'implicaton'; did you mean 'implication'"),
        (lambda s: edits.set_inference(s, implication="maximum"), "Invalid enum value 'maximum'"),
        (lambda s: edits.set_inference(s, resolution=Sampling(0)), "0 points: valid are 2 to 100000"),
        (lambda s: edits.set_no_fire(s, "T", NoFire("default", 1e13)), "default 1e+13: valid is a finite number"),
        (lambda s: edits.set_no_fire(s, "e", NoFire()), "'e' is an input"),
        (lambda s: edits.set_out_of_range(s, "T", "clamp"), "'T' is an output"),
        (lambda s: edits.set_name(s, ""), "the system's name is empty"),
        (lambda s: edits.set_notes(s, "\x00"), "which cannot be printed"),
    ],
)
def test_what_cannot_be_says_why(edit, message):
    with pytest.raises(InvalidSystemError) as caught:
        edit(DIAGONAL)
    assert message in str(caught.value)


@given(_system_and_term(), st.data())
@settings(max_examples=40)
def test_removing_an_added_term_restores_the_system(drawn, data):
    system, name, _ = drawn
    found = _variable(system, name)
    place = data.draw(st.integers(0, len(found.terms)))
    shape = Triangle(found.low, (found.low + found.high) / 2, found.high)
    added = edits.add_term(system, name, "fresh", shape, place)
    assert _variable(added, name).terms[place] == Term("fresh", shape)
    assert all_rules(added) == all_rules(system)
    assert edits.remove_term(added, name, "fresh") == system


@given(_system_and_term())
@settings(max_examples=40)
def test_removing_a_term_removes_just_the_rules_that_need_it(drawn):
    system, name, term = drawn
    assume(len(_variable(system, name).terms) > 1)
    removed = edits.remove_term(system, name, term)
    gone = Is(name, term)
    expected = []
    for rule in all_rules(system):
        kept = tuple(consequent for consequent in rule.consequents if consequent != gone)
        if kept and gone not in propositions(rule.antecedent):
            expected.append(replace(rule, consequents=kept))
    assert list(all_rules(removed)) == expected


def test_the_last_term_stays():
    system = FuzzySystem("s", (Input("e", 0, 1, (Term("N", Triangle(0, 0, 1)),)),), DIAGONAL.outputs)
    with pytest.raises(InvalidSystemError, match=r"inputs.e.terms: 0 terms: valid are 1 to 64"):
        edits.remove_term(system, "e", "N")


def test_options_are_set():
    system = edits.set_inference(DIAGONAL, implication="product", resolution=Sampling(13, "endpoints"))
    assert system.inference == replace(DIAGONAL.inference, implication="product", resolution=Sampling(13, "endpoints"))
    assert edits.set_no_fire(DIAGONAL, "T", NoFire("hold")).outputs[0].no_fire == NoFire("hold")
    assert edits.set_out_of_range(DIAGONAL, "e", "reject").inputs[0].out_of_range == "reject"
    assert edits.set_name(DIAGONAL, "mine").name == "mine"
    assert edits.set_notes(DIAGONAL, "a\nb").notes == "a\nb"
