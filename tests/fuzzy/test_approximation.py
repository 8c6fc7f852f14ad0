"""Approximators: exact where they can be, optimal by their criterion, and better with more rules."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from fuzzy import edits, load, save
from fuzzy.approximation import fit, fit_gaussians
from fuzzy.errors import InvalidInputError
from fuzzy.inference import compile_system
from fuzzy.shapes import Ramp
from fuzzy.system import FuzzySystem, Input, Output, Term

X = Input("x", 0.0, 2.0, (Term("low", Ramp(2.0, 0.0)), Term("high", Ramp(0.0, 2.0))))
Y = Input("y", -1.0, 1.0, (Term("low", Ramp(1.0, -1.0)), Term("high", Ramp(-1.0, 1.0))))
Z = Output("z", 0.0, 1.0, (Term("any", Ramp(0.0, 1.0)),))
SYSTEM = FuzzySystem("corners", (X, Y), (Z,))


def evenly(count: int) -> FuzzySystem:
    return edits.space_terms(edits.space_terms(SYSTEM, "x", count), "y", count)


def wavy(x):
    return np.sin(2.0 * x[:, 0]) * np.cos(1.5 * x[:, 1]) + 0.2 * x[:, 0]


@pytest.mark.parametrize("criterion", ["least_squares", "minimax"])
def test_what_ramps_and_products_can_say_is_said_exactly(criterion):
    found = fit(SYSTEM, lambda x: 3.0 - 2.0 * x[:, 0] + 5.0 * x[:, 1] + 1.5 * x[:, 0] * x[:, 1], criterion=criterion)
    assert found.largest < 1e-9
    assert compile_system(found.system)(0.3, 0.7) == pytest.approx(3.0 - 0.6 + 3.5 + 0.315)


def test_data_at_the_peaks_are_the_consequents():
    x = np.array([(a, b) for a in (0.0, 2.0) for b in (-1.0, 1.0)])
    found = fit(SYSTEM, (x, [1.0, 2.0, 3.0, 4.0]))
    shapes = [term.shape for term in found.system.outputs[0].terms]
    assert [shape.value for shape in shapes] == pytest.approx([1.0, 2.0, 3.0, 4.0])  # type: ignore[union-attr]


def test_minimax_has_the_smaller_greatest_error_and_least_squares_the_smaller_mean():
    x = np.random.default_rng(1).uniform((0.0, -1.0), (2.0, 1.0), (400, 2))
    target = (x, wavy(x))
    squares, minimax = (fit(evenly(3), target, criterion=each) for each in ("least_squares", "minimax"))
    assert squares.rms < minimax.rms
    assert minimax.largest < squares.largest
    # Chebyshev: the least greatest error is reached at one place more than there are parameters.
    error = np.abs(compile_system(minimax.system).batch(x)[:, 0] - wavy(x))
    assert (error > minimax.largest * (1 - 1e-6)).sum() > 9


def test_the_error_falls_with_the_square_of_the_distance_between_the_terms():
    errors = [fit(evenly(count), wavy).rms for count in (3, 5, 9)]
    orders = [math.log2(first / second) for first, second in itertools.pairwise(errors)]
    assert orders == pytest.approx([2.0, 2.0], abs=0.4)


def test_own_gaussians_do_better_than_as_many_given_sets():
    given = fit(evenly(3), wavy)
    own = fit_gaussians(SYSTEM, wavy, rules=9)
    assert own.rms < 0.25 * given.rms
    assert len(own.system.rules.list) == 9


@pytest.mark.parametrize("seed", range(5))
def test_what_few_gaussians_can_say_is_found_again(seed):
    said = compile_system(fit_gaussians(SYSTEM, wavy, rules=3, seed=seed).system)
    again = fit_gaussians(SYSTEM, lambda x: said.batch(x)[:, 0], rules=3, seed=seed)
    assert again.largest < 1e-4


def test_rules_that_no_sample_excites_say_the_mean():
    found = fit(evenly(5), ([[0.0, -1.0], [0.0, -1.0], [0.1, -0.9]], [1.0, 1.0, 4.0]))
    assert found.silent == 25 - 4
    assert compile_system(found.system)(2.0, 1.0) == pytest.approx(2.0)


def test_an_approximator_is_a_file_like_any_other(tmp_path):
    found = fit(evenly(3), wavy)
    save(found.system, tmp_path / "wavy.yaml")
    again = compile_system(load(tmp_path / "wavy.yaml"))
    places = np.random.default_rng(2).uniform((0.0, -1.0), (2.0, 1.0), (100, 2))
    assert (again.batch(places) == compile_system(found.system).batch(places)).all()


@pytest.mark.parametrize(
    ("target", "message"),
    [
        (([[0.0]], [1.0]), r"inputs of shape \(1, 1\)"),
        (([[0.0, 0.0]], [1.0, 2.0]), r"values of shape \(2,\)"),
        (([[0.0, math.nan]], [1.0]), "not finite"),
        (([["a", "b"]], [1.0]), "no table of numbers"),
        ((np.empty((0, 2)), []), "n from 1"),
        (lambda x: x, r"values of shape \(4096, 2\)"),
    ],
)
def test_what_is_no_data_is_refused(target, message):
    with pytest.raises(InvalidInputError, match=message):
        fit(SYSTEM, target)


def test_too_many_rules_are_refused():
    with pytest.raises(InvalidInputError, match="289 combinations of input terms; valid: at most 256"):
        fit(evenly(17), wavy)
    with pytest.raises(InvalidInputError, match="65 rules; valid: 1 to 64"):
        fit_gaussians(SYSTEM, wavy, rules=65)
