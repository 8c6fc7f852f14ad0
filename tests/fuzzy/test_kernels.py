"""The parts of the kernels: operators and polynomials of clipped sets."""

from __future__ import annotations

import itertools
import math
import threading
import typing
from fractions import Fraction

import numba
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzy import geometry, sets, shapes
from fuzzy.compiler import rules as compiled_rules
from fuzzy.kernels import codes, exact, norms, places, quadrature, sampled
from fuzzy.kernels.jit import compiled_for
from fuzzy.system import SNorm, TNorm
from tests import generated, plain, reference, strategies

DEGREES = st.floats(0.0, 1.0) | st.floats(0.0, 16.0).map(lambda n: 1.0 - 10.0**-n)
"""Some of them so near to 1 that the difference from it is easily lost."""
SIXTY_FOURTHS = st.integers(0, 64).map(lambda n: n / 64)
"""Degrees whose sums are exact: two norms jump where a + b = 1."""
T_NORMS = {name: compiled_rules.T_NORM[name] for name in typing.get_args(TNorm)}
S_NORMS = {name: compiled_rules.S_NORM[name] for name in typing.get_args(SNorm)}
JUMPING = ("drastic_product", "nilpotent_minimum", "drastic_sum", "nilpotent_maximum")
DUALS = list(zip(T_NORMS, S_NORMS, strict=True))


@pytest.mark.parametrize("name", T_NORMS)
@given(a=SIXTY_FOURTHS, b=SIXTY_FOURTHS, c=SIXTY_FOURTHS)
def test_t_norms_obey_their_laws(name, a, b, c):
    def t(x: float, y: float) -> float:
        return norms.t_norm(T_NORMS[name], x, y)

    assert t(a, 0.0) == 0.0
    assert t(a, b) == t(b, a)
    assert t(a, b) <= min(a, b)
    assert t(min(a, b), c) <= t(max(a, b), c) + 1e-15
    if name not in ("drastic_product", "nilpotent_minimum"):  # rounding may cross their jump in the second step
        assert t(a, t(b, c)) == pytest.approx(t(t(a, b), c), abs=1e-13)


@pytest.mark.parametrize("name", S_NORMS)
@given(a=SIXTY_FOURTHS, b=SIXTY_FOURTHS, c=SIXTY_FOURTHS)
def test_s_norms_obey_their_laws(name, a, b, c):
    def s(x: float, y: float) -> float:
        return norms.s_norm(S_NORMS[name], x, y)

    assert s(a, 1.0) == pytest.approx(1.0, abs=1e-15)
    assert s(a, b) == s(b, a)
    assert max(a, b) - 1e-15 <= s(a, b) <= 1.0
    assert s(min(a, b), c) <= s(max(a, b), c) + 1e-15
    if name not in ("drastic_sum", "nilpotent_maximum"):
        assert s(a, s(b, c)) == pytest.approx(s(s(a, b), c), abs=1e-13)


@pytest.mark.parametrize("name", [*T_NORMS, *S_NORMS])
@given(a=DEGREES, b=DEGREES)
def test_norms_are_their_definitions_and_have_a_neutral_element(name, a, b):
    is_t_norm = name in T_NORMS
    code = (T_NORMS if is_t_norm else S_NORMS)[name]
    definition = (reference.T_NORMS if is_t_norm else reference.S_NORMS)[name]
    norm = norms.t_norm if is_t_norm else norms.s_norm
    assert norm(code, a, 1.0 if is_t_norm else 0.0) == a
    if name not in JUMPING:
        exact = float(definition(Fraction(a), Fraction(b)))
        assert norm(code, a, b) == pytest.approx(exact, rel=1e-15, abs=1e-16)


@pytest.mark.parametrize("name", JUMPING)
@given(a=SIXTY_FOURTHS, b=SIXTY_FOURTHS)
def test_norms_that_jump_do_so_where_they_should(name, a, b):
    if name in T_NORMS:
        assert norms.t_norm(T_NORMS[name], a, b) == reference.T_NORMS[name](a, b)
    else:
        assert norms.s_norm(S_NORMS[name], a, b) == reference.S_NORMS[name](a, b)


@given(a=st.floats(1e-12, 1.0 - 1e-12), ulps=st.integers(-3, 3))
def test_degrees_that_add_up_to_1_but_for_rounding_do_so(a, ulps):
    b = 1.0 - a + ulps * math.ulp(0.5)
    assert norms.t_norm(norms.NILPOTENT_MINIMUM, a, b) == 0.0
    assert norms.s_norm(norms.NILPOTENT_MAXIMUM, a, b) == 1.0


@pytest.mark.parametrize(("t", "s"), DUALS)
@given(a=SIXTY_FOURTHS, b=SIXTY_FOURTHS)
def test_norms_are_dual(t, s, a, b):
    assert norms.s_norm(S_NORMS[s], a, b) == pytest.approx(1 - norms.t_norm(T_NORMS[t], 1 - a, 1 - b), abs=1e-15)


@given(strategies.shapes_on(0.0, 1.0, needs_area=True, has_gaussians=False), st.floats(0.0, 1.0))
def test_polynomials_give_area_and_moment_of_a_clipped_set(shape, height):
    segments = geometry.clipped_to(sets.segments(plain.term(shape)), 0.0, 1.0)
    rows = geometry.cut_polynomials(segments, 0.5)
    row = [row for row in rows if row[0] <= height][-1]
    d = height - row[0]
    area = row[1] + d * (row[2] + d * row[3])
    moment = row[4] + d * (row[5] + d * (row[6] + d * row[7]))
    points = sorted({end for segment in segments for end in segment[:2]})
    u = np.concatenate([a + (b - a) * (np.arange(20_000) + 0.5) / 20_000 for a, b in itertools.pairwise(points)])
    weight = np.concatenate([np.full(20_000, (b - a) / 20_000) for a, b in itertools.pairwise(points)])
    clipped = weight * np.minimum(plain.degrees(shape, u), height)
    assert area == pytest.approx(clipped.sum(), abs=1e-7)
    assert moment == pytest.approx((clipped * (u - 0.5)).sum(), abs=1e-7)


@given(
    strategies.shapes_on(0.0, 1.0, has_gaussians=False),
    strategies.shapes_on(0.0, 1.0, has_gaussians=False),
    st.floats(0.0, 1.0),
)
def test_an_intersection_is_the_smaller_of_two_sets(one, other, u):
    parts = geometry.intersection(sets.segments(plain.term(one)), sets.segments(plain.term(other)), 0.0, 1.0)
    for part in parts:
        x = part.left + u * (part.right - part.left)
        if part.left < x < part.right:
            smaller = min(plain.degrees(one, x), plain.degrees(other, x))
            steepness = max(1.0, abs(part.at_right - part.at_left) / (part.right - part.left))
            assert geometry.degree(part, x) == pytest.approx(smaller, abs=1e-13 * steepness)
    if not any(part.left <= u <= part.right for part in parts) and 0.0 < u < 1.0:
        assert min(plain.degrees(one, u), plain.degrees(other, u)) == 0.0 or _is_vertex(u, one, other)


def _is_vertex(u: float, *given: shapes.Shape) -> bool:
    return any(u in sets.break_points(plain.term(shape)) for shape in given)


@given(st.lists(st.floats(allow_nan=False), max_size=12), st.integers(0, 12))
def test_sort_orders_the_first_values(values, count):
    count = min(count, len(values))
    array = np.array(values, dtype=np.float64)
    exact.sort(array, count)
    assert array.tolist() == sorted(values[:count]) + values[count:]


def test_gauss_and_kronrod_rules_integrate_polynomials_exactly():
    nodes = np.concatenate([-quadrature._NODE[1:], quadrature._NODE[1:-1]])
    for rule, order in ((quadrature._KRONROD, 22), (quadrature._GAUSS, 13)):
        weights = np.concatenate([rule[1:], rule[1:-1]])
        for power in range(order + 1):
            wanted = 2 / (power + 1) if power % 2 == 0 else 0.0
            assert (weights * nodes**power).sum() == pytest.approx(wanted, abs=1e-15)
    assert quadrature._KRONROD[0] == quadrature._GAUSS[0] == 0.0


@given(st.integers(0, 2**32 - 1))
def test_between_its_turns_a_set_rises_or_falls(seed):
    # An envelope is followed by its sets' degrees at these places only.
    (system,) = generated.systems(1, seed, curved=True, varied=True)
    for output in system.outputs:
        for term in output.terms:
            encoded = sets.encode(term)
            if encoded.code in (codes.SIGMOID_DIFFERENCE, codes.LINEAR):
                continue
            found = np.zeros(max(codes.MOST_BENDS, 2 * len(encoded.values)))
            row, values = np.array(encoded.parameters), np.array(encoded.values)
            count = places.turns(encoded.code, row, values, 0.3, found, 0)
            inside = found[:count][(found[:count] > output.low) & (found[:count] < output.high)]
            for left, right in itertools.pairwise([output.low, *np.unique(inside), output.high]):
                inset = 1e-9 * (right - left)  # a set may jump at its turns
                steps = np.diff(sets.degrees(term, np.linspace(left + inset, right - inset, 60)))
                assert (steps >= -1e-14).all() or (steps <= 1e-14).all(), (term, left, right)


def test_an_addressed_kernel_keeps_its_address():
    assert sampled.centroid.address == sampled.centroid.address != exact.clipped_centroid.address != 0


def test_a_compiled_kernel_converts_other_numbers_and_is_compiled_once():
    @numba.njit
    def half(value):
        return value / 2

    threads = [threading.Thread(target=compiled_for, args=(half, 1.0)) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    entry = compiled_for(half, 2.0)
    assert entry(3) == entry(3.0) == 1.5
    assert len(half.signatures) == 1
    with pytest.raises(TypeError):
        entry("three")
