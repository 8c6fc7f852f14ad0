"""Terms in number and in order: even spacing, insertion, order, and symmetric editing."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import fuzzy
from fuzzy import edits, motion, partition, shapes
from fuzzy.errors import InvalidSystemError
from fuzzy.formats import load
from fuzzy.rules import all_rules
from fuzzy.shapes import Gaussian, Linear, Shape, Triangle
from fuzzy.system import FuzzySystem, Input, Output
from tests import plain, strategies

RULEBASES = Path(__file__).parents[2] / "rulebases"
DIAGONAL = load(RULEBASES / "diagonal.yaml")
PILTAN = load(RULEBASES / "piltan.yaml")


def variable(system: FuzzySystem, name: str) -> Input | Output:
    return next(entry for entry in (*system.inputs, *system.outputs) if entry.name == name)


def names(system: FuzzySystem, name: str) -> list[str]:
    return [term.name for term in variable(system, name).terms]


def degrees_sum(system: FuzzySystem, name: str) -> np.ndarray:
    """Return the sum of the degrees between the outermost tops."""
    found = variable(system, name)
    tops = [partition.core(term.shape) for term in found.terms]
    x = np.linspace(max(found.low, min(tops)[0]), min(found.high, max(tops)[1]), 301)
    return sum((plain.degrees(term.shape, x) for term in found.terms), np.zeros(x.size))


@given(strategies.systems(max_rules=3), st.integers(1, 12), st.data())
@settings(max_examples=60)
def test_even_terms_are_a_partition_and_every_rule_stays_one(system, count, data):
    found = data.draw(st.sampled_from((*system.inputs, *system.outputs)))
    spaced = edits.space_terms(system, found.name, count)
    terms = variable(spaced, found.name).terms
    assert len(terms) == count
    if count > 1:
        assert degrees_sum(spaced, found.name) == pytest.approx(1.0, abs=1e-9)
        tops = [term.shape.b for term in terms if isinstance(term.shape, Triangle)]
        assert (tops[0], tops[-1]) == pytest.approx((found.low, found.high))
        assert np.ptp(np.diff(tops)) <= 1e-9 * (found.high - found.low)
    assert len(spaced.rules.list) == len(system.rules.list)
    if count == len(found.terms):
        assert {term.name for term in terms} == {term.name for term in found.terms}


@pytest.mark.parametrize("count", [1, 2, 3, 4, 5, 6, 8, 9, 11])
@pytest.mark.parametrize("name", ["e", "de", "T"])
def test_a_table_follows_and_stays_antisymmetric(name, count):
    spaced = edits.space_terms(DIAGONAL, name, count)
    cells = edits.rule_table(spaced).cells
    rank = {term: n for n, term in enumerate(names(spaced, "T"))}
    # With an even number of output terms the middle one has no single follower.
    if name != "T" or count % 2:
        for i, row in enumerate(cells):
            for j, cell in enumerate(row):
                opposite = cells[len(cells) - 1 - i][len(row) - 1 - j]
                assert cell is not None
                assert opposite is not None
                assert rank[cell] + rank[opposite] == len(rank) - 1
    corner = fuzzy.compile_system(spaced).batch([[1.0, 6.0]])[0, 0]
    assert corner > 0 or count == 1


def test_seven_terms_become_five_and_names_are_usual_where_they_were():
    assert names(edits.space_terms(DIAGONAL, "e", 5), "e") == ["NB", "NS", "Z", "PS", "PB"]
    assert names(edits.space_terms(DIAGONAL, "T", 5), "T") == ["LL", "ML", "Z", "MR", "LR"]
    assert names(edits.space_terms(DIAGONAL, "T", 9), "T") == [
        *("LL", "ML", "ML 2", "SL", "Z", "SR", "MR", "MR 2", "LR"),
    ]
    assert names(edits.space_terms(edits.space_terms(DIAGONAL, "e", 5), "e", 7), "e") == names(DIAGONAL, "e")


def test_the_shipped_terms_are_evenly_spaced():
    for name in ("e", "de", "T"):
        spaced = edits.space_terms(DIAGONAL, name, 7)
        for term, expected in zip(variable(spaced, name).terms, variable(DIAGONAL, name).terms, strict=True):
            assert term.name == expected.name
            assert shapes.parameters(term.shape) == pytest.approx(shapes.parameters(expected.shape), abs=0.05)


def test_even_terms_of_another_shape():
    spaced = edits.space_terms(DIAGONAL, "e", 5, "gaussian")
    assert all(isinstance(term.shape, Gaussian) for term in spaced.inputs[0].terms)
    with pytest.raises(InvalidSystemError, match="unknown shape 'heap'"):
        edits.space_terms(DIAGONAL, "e", 5, "heap")
    for count in (0, 65):
        with pytest.raises(InvalidSystemError, match="valid are 1 to 64"):
            edits.space_terms(DIAGONAL, "e", count)


@pytest.mark.parametrize("after", ["NB", "Z", "PM", "PB"])
@pytest.mark.parametrize("name", ["e", "T"])
def test_an_inserted_term_keeps_the_partition_and_is_undone_by_removing(name, after):
    after = after if name == "e" else {"NB": "LL", "Z": "Z", "PM": "MR", "PB": "LR"}[after]
    grown = edits.insert_term(DIAGONAL, name, "new", after)
    assert len(names(grown, name)) == 8
    inside = variable(DIAGONAL, name)
    x = np.linspace(inside.low, inside.high, 101)
    assert sum(plain.degrees(term.shape, x) for term in variable(grown, name).terms) == pytest.approx(1.0)
    tops = [term.shape.b for term in variable(grown, name).terms if isinstance(term.shape, Triangle)]
    assert tops == sorted(tops)
    assert all_rules(edits.remove_term(grown, name, "new")) == all_rules(DIAGONAL)
    loose = edits.insert_term(DIAGONAL, name, "new", after, joins=False)
    assert edits.remove_term(loose, name, "new") == DIAGONAL


def test_a_term_beside_the_only_one_and_one_without_room():
    single = edits.space_terms(DIAGONAL, "e", 1)
    assert len(names(edits.insert_term(single, "e", "new", names(single, "e")[0]), "e")) == 2
    crowded = edits.set_shape(DIAGONAL, "e", "NM", Triangle(-1.2, -1, -0.5))
    with pytest.raises(InvalidSystemError, match="leave no room"):
        edits.insert_term(crowded, "e", "new", "NB")
    assert edits.fresh_name(DIAGONAL.inputs[0], "Z") == "Z 2"
    assert edits.fresh_name(DIAGONAL.inputs[0], "X") == "X"
    assert len(edits.fresh_name(edits.rename_term(DIAGONAL, "e", "Z", "x" * 64).inputs[0], "x" * 64)) == 64


@given(strategies.systems(max_rules=3), st.data())
@settings(max_examples=40)
def test_another_order_is_the_same_controller_and_is_undone(system, data):
    found = data.draw(st.sampled_from((*system.inputs, *system.outputs)))
    place = data.draw(st.integers(0, len(found.terms) - 1))
    number = data.draw(st.integers(0, len(found.terms) - 1))
    term = found.terms[number].name
    moved = edits.move_term(system, found.name, term, place)
    assert variable(moved, found.name).terms[place] == found.terms[number]
    assert set(all_rules(moved)) == set(all_rules(system))
    assert edits.move_term(moved, found.name, term, number) == system


def test_a_place_that_there_is_not_is_refused():
    with pytest.raises(InvalidSystemError, match="place 7: valid are 0 to 6"):
        edits.move_term(DIAGONAL, "e", "Z", 7)


def test_a_unit_is_kept_and_a_wrong_one_refused():
    assert edits.set_unit(DIAGONAL, "e", "rad").inputs[0].unit == "rad"
    with pytest.raises(InvalidSystemError, match="expected at most 64 printable characters"):
        edits.set_unit(DIAGONAL, "e", "\n")


# Symmetric editing


@given(strategies.shapes_on(-3.0, 5.0), st.floats(-2, 2))
@settings(max_examples=80)
def test_a_mirror_image_has_the_degrees_of_the_other_side_and_is_its_own_inverse(shape: Shape, middle: float):
    image = motion.reflected(shape, middle)
    x = np.linspace(-9, 9, 181)
    expected = plain.degrees(shape, 2 * middle - x)
    # A jump stands at one of two places that rounding tells apart.
    assert np.mean(abs(plain.degrees(image, x) - expected) > 1e-6) < 0.03
    again = motion.reflected(image, middle)
    assert type(again) is type(shape)
    assert shapes.parameters(again) == pytest.approx(shapes.parameters(shape), abs=1e-9)


@given(st.sampled_from(["e", "de", "T"]), st.integers(0, 6), st.floats(-0.9, 0.9), st.booleans())
@settings(max_examples=60)
def test_symmetric_editing_keeps_a_variable_symmetric_and_a_partition_one(name, number, share, in_partition):
    found = variable(DIAGONAL, name)
    assume(number != 3)
    term = found.terms[number]
    value = share * found.high
    mode = "partition" if in_partition else "free"
    try:
        moved = edits.move_point(DIAGONAL, name, term.name, "b", value, mode)
        after = edits.follow_in_mirror(DIAGONAL, moved, name, term.name)
    except InvalidSystemError:
        return
    terms = variable(after, name).terms
    assert terms[number] == variable(moved, name).terms[number]
    middle = (found.low + found.high) / 2
    for one, other in zip(terms, reversed(terms), strict=True):
        assert shapes.parameters(motion.reflected(one.shape, middle)) == pytest.approx(shapes.parameters(other.shape))
    if in_partition:
        assert degrees_sum(after, name) == pytest.approx(1.0)


def test_the_middle_term_stays_in_the_middle_and_spreads_to_both_sides():
    wider = edits.move_point(DIAGONAL, "e", "Z", "a", -0.5)
    after = edits.follow_in_mirror(DIAGONAL, wider, "e", "Z")
    assert after.inputs[0].terms[3].shape == Triangle(-0.5, 0.0, 0.5)
    aside = edits.move_point(DIAGONAL, "e", "Z", "b", 0.1)
    with pytest.raises(InvalidSystemError, match=r"'Z' is the middle term: .* stays in the middle, 0"):
        edits.follow_in_mirror(DIAGONAL, aside, "e", "Z")
    curved = edits.set_shape_kind(DIAGONAL, "e", "Z", "gaussian")
    assert edits.follow_in_mirror(DIAGONAL, curved, "e", "Z") == curved
    outer = edits.set_shape_kind(DIAGONAL, "e", "PB", "gaussian")
    both = edits.follow_in_mirror(DIAGONAL, outer, "e", "PB").inputs[0].terms
    assert isinstance(both[0].shape, Gaussian)
    assert both[0].shape.mean == -both[-1].shape.mean  # type: ignore[union-attr]
    assert math.isclose(both[0].shape.sigma, both[-1].shape.sigma)  # type: ignore[union-attr]


# Open sides


@given(strategies.shapes_on(-3.0, 5.0))
@settings(max_examples=60)
def test_opening_a_side_is_one_up_to_infinity_and_closing_gives_a_valid_shape(shape: Shape):
    system = edits.set_shape(DIAGONAL, "e", "Z", shape)
    for side in edits.sides_that_open(shape):
        infinity = -math.inf if side == "left" else math.inf
        was_open = infinity in shapes.parameters(shape)
        toggled = edits.toggle_open_side(system, "e", "Z", side)
        after = toggled.inputs[0].terms[3].shape
        assert type(after) is type(shape)
        assert (infinity in shapes.parameters(after)) != was_open
        assert plain.degrees(after, np.array([math.copysign(1e9, infinity)])) == (0.0 if was_open else 1.0)
        if was_open:
            assert edits.toggle_open_side(toggled, "e", "Z", side) == system


def test_a_shape_without_an_open_side_says_so():
    assert edits.sides_that_open(Gaussian(0.0, 1.0)) == ()
    assert edits.sides_that_open(Triangle(-math.inf, 0.0, 1.0)) == ("left",), "at most one side may be open"
    system = edits.set_shape(DIAGONAL, "e", "Z", Gaussian(0.0, 1.0))
    with pytest.raises(InvalidSystemError, match="a gaussian cannot be open to the left here"):
        edits.toggle_open_side(system, "e", "Z", "left")


def test_an_output_term_becomes_a_function_of_the_inputs_and_a_set_again():
    sugeno = edits.set_inference(edits.space_terms(DIAGONAL, "T", 7, "singleton"), defuzzifier="weighted_average")
    function = edits.set_shape_kind(sugeno, "T", "LR", "linear")
    assert function.outputs[0].terms[-1].shape == Linear((0.0, 0.0), 85.0)
    x = np.random.default_rng(0).uniform((-1, -6), (1, 6), (50, 2))
    assert fuzzy.compile_system(function).batch(x) == pytest.approx(fuzzy.compile_system(sugeno).batch(x))
    assert edits.set_shape_kind(function, "T", "LR", "singleton") == sugeno
    with pytest.raises(InvalidSystemError, match="linear"):
        edits.set_shape_kind(DIAGONAL, "e", "PB", "linear")


def test_height_and_complement_of_a_term():
    system = edits.set_complement(edits.set_height(DIAGONAL, "e", "Z", 0.5), "e", "Z", is_complement=True)
    assert (system.inputs[0].terms[3].height, system.inputs[0].terms[3].complement) == (0.5, True)
    assert edits.set_shape_kind(system, "e", "Z", "gaussian").inputs[0].terms[3].height == 0.5
    for height in (-0.1, 1.1, math.nan):
        with pytest.raises(InvalidSystemError, match="height"):
            edits.set_height(DIAGONAL, "e", "Z", height)


@given(strategies.systems(max_rules=4), st.data())
@settings(max_examples=40)
def test_as_many_rules_go_with_a_term_as_are_counted(system, data):
    found = data.draw(st.sampled_from((*system.inputs, *system.outputs)))
    assume(len(found.terms) > 1)
    term = data.draw(st.sampled_from(found.terms)).name
    removed = edits.remove_term(system, found.name, term)
    assert edits.rules_with(system, found.name, term) == len(all_rules(system)) - len(all_rules(removed))
