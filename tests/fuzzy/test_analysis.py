"""Analysis against closed forms, single calls and symmetries."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

import fuzzy
from fuzzy import analysis
from fuzzy.errors import InvalidInputError
from fuzzy.inference import Controller, compile_system
from fuzzy.shapes import Gaussian, Trapezoid, Triangle
from fuzzy.system import FuzzySystem, Inference, Input, Is, NoFire, Output, Rule, RuleBase, RuleTable, Term
from tests import generated

DIAGONAL = fuzzy.load(Path(__file__).parents[2] / "rulebases" / "diagonal.yaml")
INTERPOLATING = Inference(conjunction="product", implication="product", aggregation="sum")
"""With a partition and output sets of one area, the surface interpolates between the sets' centroids."""

OPEN = math.inf


def partition(*peaks: float) -> tuple[Term, ...]:
    ends = [-OPEN, *peaks, OPEN]
    return tuple(Term(f"t{i}", Triangle(ends[i], ends[i + 1], ends[i + 2])) for i in range(len(peaks)))


def blocks(low: float, high: float, *centroids: float, width: float = 0.5) -> Output:
    """Return an output whose sets are rectangles of one area around given centroids."""
    return Output(
        "y", low, high, tuple(Term(f"s{i}", Trapezoid(c - width, c - width, c + width, c + width))
                              for i, c in enumerate(centroids)), no_fire=NoFire("nan"),
    )  # fmt: skip


def one_to_one(variable: Input, output: Output, inference: Inference = INTERPOLATING) -> Controller:
    rules = tuple(
        Rule(Is(variable.name, term.name), (Is(output.name, output.terms[i].name),))
        for i, term in enumerate(variable.terms)
    )
    return compile_system(FuzzySystem("curve", (variable,), (output,), RuleBase(list=rules), inference))


def two_to_one(cells: list[list[int]], inference: Inference = INTERPOLATING) -> Controller:
    """Return a controller on [-1, 1] x [-2, 2] whose output sets lie at -3 ... 3."""
    n, m = len(cells), len(cells[0])
    first = Input("e", -1.0, 1.0, partition(*np.linspace(-1, 1, n).tolist()))
    second = Input("de", -2.0, 2.0, partition(*np.linspace(-2, 2, m).tolist()))
    table = RuleTable("e", "de", "y", tuple(tuple(f"s{cell + 3}" for cell in row) for row in cells))
    output = blocks(-4.0, 4.0, *range(-3, 4))
    return compile_system(FuzzySystem("plane", (first, second), (output,), RuleBase(table), inference))


# surface and section


@settings(max_examples=12, deadline=None)
@given(seed=st.integers(0, 10**6), nx=st.integers(2, 9), ny=st.integers(2, 9))
def test_a_surface_is_what_single_calls_say(seed, nx, ny):
    random = np.random.default_rng(seed)
    system = generated.system(random, "any", curved=False, ordered=False)
    controller = compile_system(system)
    names = [variable.name for variable in system.inputs]
    at = {v.name: v.low + random.random() * (v.high - v.low) for v in system.inputs}
    if len(names) == 1:
        found = analysis.section(controller, points=nx)
        calls = [controller.batch([[x]])[0, 0] for x in found.x]
        np.testing.assert_array_equal(found.value, calls)
        return
    x_name, y_name = (str(name) for name in random.permutation(names)[:2])
    output = system.outputs[-1].name
    found = analysis.surface(controller, x_name, y_name, (nx, ny), at, output)
    assert found.value.shape == (ny, nx)
    assert set(found.at) == set(names) - {x_name, y_name}
    for j, y in enumerate(found.y):
        for i, x in enumerate(found.x):
            place = {**found.at, x_name: x, y_name: y}
            trace = controller.explain(*(place[name] for name in names))
            np.testing.assert_array_equal(found.value[j, i], trace.outputs[output].value)


def test_a_section_is_a_row_of_the_surface():
    controller = compile_system(DIAGONAL)
    surface = analysis.surface(controller, "de", "e", (31, 5))
    for y, row in zip(surface.y, surface.value, strict=True):
        section = analysis.section(controller, "de", {"e": y}, 31)
        np.testing.assert_array_equal(section.value, row)
        np.testing.assert_array_equal(section.x, surface.x)
        assert section.at == {"e": y}


def test_the_shipped_table_gives_an_odd_surface_and_mirrored_gains():
    controller = compile_system(DIAGONAL)
    value = analysis.surface(controller, points=(40, 40)).value
    np.testing.assert_allclose(value, -value[::-1, ::-1], atol=1e-12 * 170)
    for place in ((0.11, 2.3), (1 / 3, 2.0), (-0.9, 5.0)):
        here = analysis.local_gains(controller, place)
        there = analysis.local_gains(controller, [-value for value in place])
        np.testing.assert_allclose(here.left, there.right, atol=1e-7 * 85)
        np.testing.assert_allclose(here.right, there.left, atol=1e-7 * 85)


# gains


def rational(x: float, first: float, second: float) -> tuple[float, float]:
    """Return value and slope of (1 - x) x 1 + x x 3 weighted with the sets' areas."""
    area = (1 - x) * first + x * second
    value = ((1 - x) * first * 1 + x * second * 3) / area
    return value, first * second * 2 / area**2


@given(x=st.floats(1e-3, 1 - 1e-3), ratio=st.floats(0.2, 5.0))
@settings(max_examples=60, deadline=None)
def test_the_slope_of_a_rational_surface(x, ratio):
    sets = (Trapezoid(0.5, 0.5, 1.5, 1.5), Trapezoid(3 - ratio / 2, 3 - ratio / 2, 3 + ratio / 2, 3 + ratio / 2))
    output = Output("y", -3.0, 7.0, tuple(Term(f"s{i}", shape) for i, shape in enumerate(sets)))
    controller = one_to_one(Input("x", 0.0, 1.0, partition(0.0, 1.0)), output)
    value, slope = rational(x, 1.0, ratio)
    assert controller(x) == pytest.approx(value, abs=1e-12)
    gains = analysis.local_gains(controller, [x])
    # Near an end less room is left for the steps.
    accepted = 10 * (1e-9 + 1e-13 / min(x, 1 - x))
    assert abs(gains.left[0, 0] - slope) <= accepted
    assert abs(gains.right[0, 0] - slope) <= accepted
    assert not gains.bends[0, 0]
    assert gains.gain[0, 0] == pytest.approx(slope, abs=accepted)


@given(
    centroids=st.lists(st.floats(-3.0, 3.0), min_size=4, max_size=4),
    cell=st.integers(0, 2),
    distance=st.sampled_from([0.0, 1e-6, -1e-6, 1e-4, -1e-4, 0.01, 0.03, -0.03, 0.2]),
)
@settings(max_examples=80, deadline=None)
def test_slopes_left_and_right_of_a_bend_however_near_it_is(centroids, cell, distance):
    peaks = [-2.0, -0.5, 1.0, 2.0]
    controller = one_to_one(Input("x", -2.0, 2.0, partition(*peaks)), blocks(-4.0, 4.0, *centroids))
    slopes = np.diff(centroids) / np.diff(peaks)
    if cell == 0:
        return
    gains = analysis.local_gains(controller, {"x": peaks[cell] + distance})
    left = slopes[cell - 1] if distance <= 0 else slopes[cell]
    right = slopes[cell] if distance >= 0 else slopes[cell - 1]
    accepted = 1e-9 + 1e-13 / max(abs(distance), 1e-3) if distance == 0 else 1e-9 + 1e-13 / abs(distance)
    assert abs(gains.left[0, 0] - left) <= accepted
    assert abs(gains.right[0, 0] - right) <= accepted
    if distance == 0 and abs(left - right) > 1e-5:
        assert gains.bends[0, 0]
        assert gains.gain[0, 0] == pytest.approx((left + right) / 2, abs=1e-8)
    elif distance != 0:
        assert not gains.bends[0, 0]


def test_the_stated_error_is_an_upper_bound_on_the_shipped_surface():
    # Slopes by exact arithmetic are not at hand; slopes of the mirrored place are, and they have errors of their own.
    controller = compile_system(DIAGONAL)
    for place in np.random.default_rng(3).uniform((-1, -6), (1, 6), (15, 2)):
        here, there = (analysis.local_gains(controller, sign * place) for sign in (1.0, -1.0))
        assert (abs(here.left - there.right) <= here.error + there.error + 1e-9).all()
        assert (here.error < 1e-4).all()


def test_no_slope_beyond_the_universe_and_the_other_one_counts():
    controller = two_to_one([[-2, -1], [1, 2]])
    for e, de in ((-1.0, 2.0), (1.0, -2.0)):
        gains = analysis.local_gains(controller, (e, de))
        assert math.isnan((gains.left if e < 0 else gains.right)[0, 0])
        assert math.isnan((gains.left if de < 0 else gains.right)[0, 1])
        np.testing.assert_allclose(gains.gain, [[1.5, 0.25]], atol=1e-8)
        assert not gains.bends.any()


def test_a_jump_has_an_infinite_slope():
    terms = (Term("low", Trapezoid(-OPEN, 0.0, 1.0, 1.0)), Term("high", Trapezoid(1.5, 1.5, 2.0, OPEN)))
    output = replace(blocks(-4.0, 4.0, -2.0, 3.0), no_fire=NoFire("default", 0.0))
    controller = one_to_one(Input("x", 0.0, 2.0, terms), output)
    first, second = (analysis.local_gains(controller, [x]) for x in (1.0, 1.5))
    assert (first.left[0, 0], first.right[0, 0]) == (pytest.approx(0.0, abs=1e-9), OPEN)
    assert (second.left[0, 0], second.right[0, 0]) == (OPEN, pytest.approx(0.0, abs=1e-9))
    assert first.bends[0, 0]
    assert second.bends[0, 0]
    assert not analysis.local_gains(controller, [1.0001]).bends[0, 0]


def test_an_undefined_output_has_no_slope():
    terms = (Term("low", Trapezoid(-OPEN, 0.0, 1.0, 1.0)), Term("high", Trapezoid(1.5, 1.5, 2.0, OPEN)))
    controller = one_to_one(Input("x", 0.0, 2.0, terms), blocks(-4.0, 4.0, -2.0, 3.0))
    inside, edge = (analysis.local_gains(controller, [x]) for x in (1.25, 1.0))
    assert math.isnan(inside.gain[0, 0])
    assert not inside.bends[0, 0]
    assert edge.left[0, 0] == pytest.approx(0.0, abs=1e-9)
    assert math.isnan(edge.right[0, 0])


def test_curved_sets_have_smooth_slopes():
    terms = (Term("low", Gaussian(0.0, 0.4)), Term("high", Gaussian(1.0, 0.4)))
    controller = one_to_one(Input("x", 0.0, 1.0, terms), blocks(-4.0, 4.0, -2.0, 2.0))
    # y = 2 tanh((2x - 1) / (4 s²)), from the ratio of the two degrees
    for x in (0.1, 0.5, 0.77):
        inner = (2 * x - 1) / (4 * 0.4**2)
        assert controller(x) == pytest.approx(2 * math.tanh(inner), abs=1e-12)
        slope = 2 / (2 * 0.4**2) / math.cosh(inner) ** 2
        assert analysis.local_gains(controller, [x]).gain[0, 0] == pytest.approx(slope, abs=8e-9)


def test_a_plane_is_the_pd_law_that_it_is():
    plane = [[i + j for j in (-1, 0, 1)] for i in (-2, 0, 2)]
    gains = analysis.equivalent_gains(two_to_one(plane))
    assert gains.bends == (False, False)
    for found in (gains.proportional, gains.mean_proportional, gains.least_proportional, gains.greatest_proportional):
        assert found == pytest.approx(2.0, abs=1e-8)
    for found in (gains.derivative, gains.mean_derivative, gains.least_derivative, gains.greatest_derivative):
        assert found == pytest.approx(0.5, abs=1e-8)


@given(st.lists(st.lists(st.integers(-3, 3), min_size=3, max_size=3), min_size=4, max_size=4))
@settings(max_examples=30, deadline=None)
def test_gains_of_a_monotone_table_are_not_negative_and_enclose_their_mean(cells):
    table = np.sort(np.sort(np.array(cells), axis=0), axis=1).tolist()
    gains = analysis.equivalent_gains(two_to_one(table), points=5)
    assert gains.least_proportional >= -1e-8
    assert gains.least_derivative >= -1e-8
    assert gains.least_proportional - 1e-8 <= gains.mean_proportional <= gains.greatest_proportional + 1e-8
    assert gains.least_derivative - 1e-8 <= gains.mean_derivative <= gains.greatest_derivative + 1e-8


def test_gains_scale_with_the_ranges():
    plain = analysis.equivalent_gains(compile_system(DIAGONAL), points=11)
    # Both inputs of the shipped table are scaled alike: six times the range, a sixth of the gain.
    assert plain.proportional == pytest.approx(6 * plain.derivative, rel=1e-8)
    assert plain.proportional == pytest.approx(127.5, rel=1e-9)
    assert plain.mean_proportional == pytest.approx(6 * plain.mean_derivative, rel=1e-8)


# coverage and use


@pytest.mark.parametrize("width", [0.25, 0.5, 1.0])
def test_coverage_is_the_share_of_the_supports(width):
    terms = (Term("low", Triangle(0.0, 0.1, width)), Term("high", Triangle(1.0, 1.05, 1.0 + width)))
    controller = one_to_one(Input("x", 0.0, 2.0, terms), blocks(-4.0, 4.0, -2.0, 3.0))
    found = analysis.coverage(controller, points=4000)
    assert found.share == pytest.approx(width, abs=1 / 4000)
    assert found.samples == 4000
    silent = found.silent[:, 0]
    assert len(silent) == round((1 - found.share) * 4000)
    assert (((silent >= width) & (silent <= 1.0)) | (silent >= 1.0 + width)).all()
    assert np.isnan(controller.batch(found.silent)).all()


def test_an_output_that_no_rule_concludes_on_is_silent_everywhere():
    other = Output("z", 0.0, 1.0, (Term("any", Triangle(0.0, 0.5, 1.0)),))
    found = analysis.coverage(compile_system(replace(DIAGONAL, outputs=(*DIAGONAL.outputs, other))), points=5)
    assert (found.share, found.output_shares) == (1.0, {"T": 1.0, "z": 0.0})
    assert len(found.silent) == found.samples == 25


def test_coverage_of_many_inputs_is_spread_evenly():
    half = (Term("low", Trapezoid(0.0, 0.0, 0.5, 0.5)),)
    inputs = tuple(Input(f"x{i}", 0.0, 1.0, half) for i in range(5))
    rule = Rule(Is("x0", "low"), (Is("y", "s0"),))
    system = FuzzySystem("wide", inputs, (blocks(-1.0, 1.0, 0.0),), RuleBase(list=(rule,)))
    assert analysis.coverage(compile_system(system)).share == pytest.approx(0.5, abs=1e-3)


def test_rule_usage_is_what_explanations_say():
    for number, system in enumerate(generated.systems(30, 5)):
        controller = compile_system(system)
        random = np.random.default_rng(number)
        x = np.array([generated.inputs_for(random, system) for _ in range(7)])
        strength = np.array([controller.explain(*row).strength for row in x])
        found = analysis.rule_usage(controller, x)
        np.testing.assert_array_equal(found.greatest, strength.max(axis=0))
        np.testing.assert_allclose(found.mean, strength.mean(axis=0), rtol=1e-15)
        np.testing.assert_array_equal(found.share, (strength > 0).mean(axis=0))


# reach


def test_the_reach_is_the_centroid_of_the_end_terms():
    found = analysis.output_range(compile_system(DIAGONAL))
    assert (found.least, found.greatest) == pytest.approx((-85 + 85 / 9, 85 - 85 / 9), abs=1e-9)
    assert found.alone["LL"] == pytest.approx(found.least, abs=1e-9)
    assert found.alone["LR"] == pytest.approx(found.greatest, abs=1e-9)
    assert (found.low, found.high) == (-85.0, 85.0)


def test_nothing_lies_beyond_the_reach():
    for system in generated.systems(6, 8, aggregation="max"):
        controller = compile_system(system)
        x = np.random.default_rng(1).random((2000, len(system.inputs)))
        low, high = (np.array([getattr(v, end) for v in system.inputs]) for end in ("low", "high"))
        for n, output in enumerate(system.outputs):
            value = controller.batch(low + x * (high - low))[:, n]
            if np.isnan(value).all():
                continue
            found = analysis.output_range(controller, output.name)
            slack = 1e-3 * (output.high - output.low)
            assert found.least - slack <= np.nanmin(value)
            assert np.nanmax(value) <= found.greatest + slack
            assert controller.batch([found.least_at])[0, n] == found.least
            assert controller.batch([found.greatest_at])[0, n] == found.greatest


def test_a_peak_between_the_grid_points_is_found():
    # The output is greatest where the middle term alone fires: nowhere, so the search must climb to the ridge.
    terms = (Term("a", Gaussian(0.0, 0.3)), Term("b", Gaussian(0.61803, 0.05)), Term("c", Gaussian(1.0, 0.3)))
    controller = one_to_one(Input("x", 0.0, 1.0, terms), blocks(-4.0, 4.0, -2.0, 3.0, -2.0))
    x = np.linspace(0.6, 0.64, 400_001)[:, np.newaxis]
    assert analysis.output_range(controller).greatest == pytest.approx(controller.batch(x).max(), abs=1e-9)


# hostile input


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda c: analysis.surface(c, "E"), "did you mean 'e'"),
        (lambda c: analysis.surface(c, "e", "e"), "'e' twice; valid beside it: de"),
        (lambda c: analysis.surface(c, output="t"), "did you mean 'T'"),
        (lambda c: analysis.surface(c, points=(1, 5)), "1 points; valid: whole numbers from 2 to 2001"),
        (lambda c: analysis.surface(c, points=cast("Any", (5, 2.5))), "2.5 points"),
        (lambda c: analysis.surface(c, points=(5, True)), "True points"),
        (lambda c: analysis.surface(c, points=cast("Any", 5)), "two numbers"),
        (lambda c: analysis.surface(c, points=(10**9, 10**9)), "1000000000 points"),
        (lambda c: analysis.section(c, "d e"), "did you mean 'de'"),
        (lambda c: analysis.section(c, at={"dee": 0.0}), "did you mean 'de'"),
        (lambda c: analysis.section(c, at=[0.0]), "[0.0] is no place; valid: 2 values (e, de)"),
        (lambda c: analysis.section(c, at=cast("Any", 0.5)), "0.5 is no place; valid: 2 values (e, de)"),
        (lambda c: analysis.section(c, at=np.array([[0.5], [1.0]])), "valid: 2 values (e, de)"),
        (lambda c: analysis.section(c, at={"de": math.nan}), "de: nan is not a finite number"),
        (lambda c: analysis.section(c, at=cast("Any", {"de": "far"})), "de: 'far' is not a number"),
        (lambda c: analysis.local_gains(c, {"e": 1.5}), "e: no slope at 1.5; valid: -1 to 1"),
        (lambda c: analysis.equivalent_gains(c, "Q"), "unknown output 'Q'"),
        (lambda c: analysis.equivalent_gains(c, points=0), "0 points"),
        (lambda c: analysis.coverage(c, points=5000), "up to 16777216 places"),
        (lambda c: analysis.output_range(c, "e"), "unknown output 'e'"),
        (lambda c: analysis.rule_usage(c, []), "n > 0"),
        (lambda c: analysis.rule_usage(c, [[0.0, 0.0, 0.0]]), "valid: (n, 2)"),
        (lambda c: analysis.rule_usage(c, [[0.0, math.inf]]), "not a finite number"),
    ],
)
def test_what_cannot_be_used_is_refused_with_what_is_valid(call: Callable[[Any], Any], message: str):
    with pytest.raises(InvalidInputError) as caught:
        call(compile_system(DIAGONAL))
    assert message in str(caught.value)


def test_systems_that_have_no_surface_or_no_origin_say_so():
    curve = one_to_one(Input("x", 1.0, 2.0, partition(1.0, 2.0)), blocks(-4.0, 4.0, 0.0, 1.0))
    with pytest.raises(InvalidInputError, match="valid for this system: section"):
        analysis.surface(curve)
    with pytest.raises(InvalidInputError, match="1 inputs; valid: two"):
        analysis.equivalent_gains(curve)
    far = replace(DIAGONAL.inputs[0], low=0.5)
    with pytest.raises(InvalidInputError, match="e: no slope at 0"):
        analysis.equivalent_gains(compile_system(replace(DIAGONAL, inputs=(far, DIAGONAL.inputs[1]))))


def test_an_output_without_any_value_has_no_reach():
    silent = compile_system(replace(DIAGONAL, rules=RuleBase(), outputs=(
        replace(DIAGONAL.outputs[0], no_fire=NoFire("nan")),)))  # fmt: skip
    with pytest.raises(InvalidInputError, match="T: no rule fires anywhere"):
        analysis.output_range(silent)
    assert analysis.coverage(silent, points=3).share == 0.0


def test_a_refusing_input_can_be_analysed():
    inputs = tuple(replace(variable, out_of_range="reject") for variable in DIAGONAL.inputs)
    controller, plain = compile_system(replace(DIAGONAL, inputs=inputs)), compile_system(DIAGONAL)
    np.testing.assert_array_equal(analysis.surface(controller).value, analysis.surface(plain).value)
    np.testing.assert_array_equal(analysis.local_gains(controller, (1, -6)), analysis.local_gains(plain, (1, -6)))
    assert analysis.output_range(controller).greatest == analysis.output_range(plain).greatest
