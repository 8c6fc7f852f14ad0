"""Fuzzy approximators: Sugeno systems fitted to data or to a function.

f(x) = θᵀ ξ(x), where ξ are the rules' firing strengths divided by their sum. Of the first type (paper eqs. (39), (43))
the antecedent sets are given and θ is sought; of the second (40) each rule has Gaussians of its own, whose centres and
widths are sought too. What comes back is an ordinary system: it can be saved, explained and put into a loop.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Literal, NamedTuple

import numpy as np
from msgspec.structs import replace
from numpy.typing import ArrayLike, NDArray
from scipy import cluster, optimize

from fuzzy.analysis.places import spread
from fuzzy.errors import InvalidInputError
from fuzzy.inference import Controller, compile_system
from fuzzy.kernels import activity
from fuzzy.limits import MAX_OUTPUT_TERMS, MAX_TERMS
from fuzzy.shapes import Gaussian, Singleton
from fuzzy.system import And, FuzzySystem, Inference, Input, Is, Output, Rule, RuleBase, Term
from fuzzy.validation import validate

Numbers = NDArray[np.float64]

Target = Callable[[Numbers], ArrayLike] | tuple[ArrayLike, ArrayLike]
"""What to approximate: a function of (n, n_in) inputs with (n,) values, or such inputs and values."""

Criterion = Literal["least_squares", "minimax"]

SAMPLES = 4096
"""About how many places a function is sampled at, unless told otherwise."""

_MOST_STEPS = 200
"""Steps after which the search for centres and widths ends."""

_SILENT = 1e-9
"""Share of a rule in the output below which it says nothing about any sample."""


class Approximation(NamedTuple):
    """A fitted system and how well it fits.

    Attributes:
        system: Sugeno system of order 0 with one output, ``f``.
        rms: Root of the mean squared error.
        largest: Greatest magnitude of the error: the minimum of (42) if the criterion was minimax.
        silent: Number of rules that no sample excites; they say the mean of the values.
    """

    system: FuzzySystem
    rms: float
    largest: float
    silent: int


def fit(
    system: FuzzySystem, target: Target, *, criterion: Criterion = "least_squares", samples: int = SAMPLES
) -> Approximation:
    """Fit an approximator of the first type (39): one rule for every combination of the system's input terms.

    Args:
        system: Its inputs and their terms are taken; AND is the product. Rules and outputs play no part.
        target: What to approximate within the inputs' ranges.
        criterion: ``least_squares``, or ``minimax`` for the least greatest error (42), by linear programming.
        samples: About how many places a function is sampled at; its errors are measured at four times as many.

    Returns:
        The fitted system and its errors, over the data or the finer sampling.

    Raises:
        InvalidInputError: If the data are no finite numbers of fitting shapes, or there are too many combinations.
    """
    inputs = validate(system).inputs
    count = int(np.prod([len(variable.terms) for variable in inputs]))
    if count > MAX_OUTPUT_TERMS:
        raise InvalidInputError(f"{count} combinations of input terms; valid: at most {MAX_OUTPUT_TERMS}")
    names = itertools.product(*([Is(v.name, term.name) for term in v.terms] for v in inputs))
    frame = _frame(f"{system.name} approximator", inputs, [_all_of(propositions) for propositions in names])
    x, y = _sampled(inputs, target, samples)
    theta, silent = _consequents(_basis(frame, x), y, criterion)
    return _measured(_with_consequents(frame, theta), target, x, y, samples, silent)


def fit_gaussians(
    system: FuzzySystem,
    target: Target,
    *,
    rules: int = 12,
    samples: int = SAMPLES // 4,
    seed: int = 0,
    progress: Callable[[float], None] | None = None,
) -> Approximation:
    """Fit an approximator of the second type (40): rules with Gaussians of their own, by least squares.

    Centres begin at the means of clusters of the samples. For each choice of centres and widths the best θ follows
    from a linear problem, so that only they are searched (variable projection).

    Args:
        system: Its inputs' names and ranges are taken.
        target: What to approximate within the inputs' ranges.
        rules: Number of rules.
        samples: About how many places a function is sampled at; its errors are measured at four times as many.
        seed: Of the first centres.
        progress: Called now and then with the share, from 0 to 1, of the steps that the search may take; it often ends
            sooner. What it raises ends the search.

    Returns:
        The fitted system and its errors, over the data or the finer sampling.

    Raises:
        InvalidInputError: If the data are no finite numbers of fitting shapes, or the number of rules is not possible.
    """
    inputs = validate(system).inputs
    x, y = _sampled(inputs, target, samples)
    if not 1 <= rules <= min(MAX_TERMS, len(x)):
        raise InvalidInputError(f"{rules} rules; valid: 1 to {min(MAX_TERMS, len(x))}")
    low = np.array([variable.low for variable in inputs])
    width = np.array([variable.high for variable in inputs]) - low
    share = (np.clip(x, low, low + width) - low) / width
    centres, _ = cluster.vq.kmeans2(share, rules, minit="++", rng=np.random.default_rng(seed))
    start = np.concatenate([centres.ravel(), np.full(centres.size, np.log(0.5 * rules ** (-1.0 / len(inputs))))])
    bounds = (
        np.concatenate([np.full(centres.size, -0.5), np.full(centres.size, np.log(0.02))]),
        np.concatenate([np.full(centres.size, 1.5), np.full(centres.size, np.log(2.0))]),
    )

    steps = itertools.count(1)

    def residual(parameters: Numbers) -> Numbers:
        if progress is not None:
            progress(min(1.0, next(steps) / _MOST_STEPS))
        columns = _gaussian_basis(share, *parameters.reshape(2, rules, -1))
        theta, *_ = np.linalg.lstsq(columns, y, rcond=None)
        return columns @ theta - y

    def slopes(parameters: Numbers) -> Numbers:
        return _residual_slopes(share, y, *parameters.reshape(2, rules, -1))

    start = np.clip(start, *bounds)
    found = optimize.least_squares(residual, start, slopes, bounds, max_nfev=_MOST_STEPS).x
    centre, log_width = found.reshape(2, rules, len(inputs))
    own = tuple(
        replace(
            variable,
            terms=tuple(
                Term(f"A{n + 1}", Gaussian(float(low[i] + width[i] * c), float(width[i] * np.exp(s))))
                for n, (c, s) in enumerate(zip(centre[:, i], log_width[:, i], strict=True))
            ),
        )
        for i, variable in enumerate(inputs)
    )
    antecedents = [_all_of(tuple(Is(v.name, f"A{n + 1}") for v in own)) for n in range(rules)]
    frame = _frame(f"{system.name} approximator", own, antecedents)
    theta, silent = _consequents(_basis(frame, x), y, "least_squares")
    return _measured(_with_consequents(frame, theta), target, x, y, samples, silent)


def _gaussian_basis(share: Numbers, centre: Numbers, log_width: Numbers) -> Numbers:
    """Return (n, n_rules) shares ξ of rules with Gaussians at ``centre`` in the output at (n, n_in) places."""
    exponent = -0.5 * (((share[:, np.newaxis] - centre) / np.exp(log_width)) ** 2).sum(axis=2)
    degree = np.exp(exponent - exponent.max(axis=1, keepdims=True))
    return degree / degree.sum(axis=1, keepdims=True)


def _residual_slopes(share: Numbers, y: Numbers, centre: Numbers, log_width: Numbers) -> Numbers:
    """Return (n, 2 n_rules n_in) slopes of ξθ - y, with the best θ for each, by centres and logarithms of widths.

    Of the slopes at a fixed θ that part is left out which another θ makes up for.

    References:
        Kaufman, "A variable projection method for solving separable nonlinear least squares problems", 1975.
    """
    columns = _gaussian_basis(share, centre, log_width)
    left, singular, right = np.linalg.svd(columns, full_matrices=False)
    left = left[:, singular > max(columns.shape) * np.finfo(float).eps * singular[0]]
    theta = right[: left.shape[1]].T @ ((left.T @ y) / singular[: left.shape[1]])
    # ξ_r θ_r changes by ξ_r (θ_r - ξθ) times the change of the logarithm of the rule's firing strength.
    weight = (columns * (theta - (columns @ theta)[:, np.newaxis]))[:, :, np.newaxis]
    distance = (share[:, np.newaxis] - centre) / np.exp(log_width)
    slopes = np.concatenate([weight * distance / np.exp(log_width), weight * distance**2], axis=1)
    slopes = slopes.reshape(len(share), -1)
    return slopes - left @ (left.T @ slopes)


def _all_of(propositions: tuple[Is, ...]) -> And | Is:
    first, *others = propositions
    return And((first, *others)) if others else first


def _frame(name: str, inputs: tuple[Input, ...], antecedents: list[And | Is]) -> FuzzySystem:
    """Return a system with one rule for each antecedent, whose consequents are still 0."""
    terms = tuple(Term(f"c{n + 1}", Singleton(0.0)) for n in range(len(antecedents)))
    rules = tuple(Rule(antecedent, (Is("f", f"c{n + 1}"),)) for n, antecedent in enumerate(antecedents))
    inference = Inference(conjunction="product", aggregation="sum", defuzzifier="weighted_average")
    inputs = tuple(replace(variable, out_of_range="clamp") for variable in inputs)
    return FuzzySystem(name[:64], inputs, (Output("f", -1.0, 1.0, terms),), RuleBase(None, rules), inference)


def _with_consequents(frame: FuzzySystem, theta: Numbers) -> FuzzySystem:
    terms = tuple(Term(f"c{n + 1}", Singleton(float(value))) for n, value in enumerate(theta))
    low, high = float(theta.min()), float(theta.max())
    if high - low < 1e-6 * max(1.0, abs(low)):  # a universe has a width
        low, high = low - 0.5 * max(1.0, abs(low)), high + 0.5 * max(1.0, abs(low))
    default = min(max(0.0, low), high)
    output = replace(frame.outputs[0], low=low, high=high, terms=terms)
    return validate(replace(frame, outputs=(replace(output, no_fire=replace(output.no_fire, value=default)),)))


def _basis(frame: FuzzySystem, x: Numbers) -> Numbers:
    """Return (n, n_rules) shares ξ of the rules in the output; 0 where none fires."""
    directory = Controller(frame).directory()
    strength = np.zeros((len(x), len(frame.rules.list)))
    activity.strengths(directory.address, x, np.zeros(1), strength)
    total = strength.sum(axis=1, keepdims=True)
    return np.divide(strength, total, out=strength, where=total > 0)


def _consequents(basis: Numbers, y: Numbers, criterion: Criterion) -> tuple[Numbers, int]:
    """Return θ and the number of rules that no sample excites."""
    heard = basis.max(axis=0) > _SILENT
    theta = np.full(basis.shape[1], y.mean())
    columns = basis[:, heard]
    if criterion == "least_squares":
        theta[heard] = np.linalg.lstsq(columns, y, rcond=None)[0]
    else:
        # min t with -t <= columns θ - y <= t
        one = np.ones((len(y), 1))
        rows, limits = np.block([[columns, -one], [-columns, -one]]), np.concatenate([y, -y])
        cost = np.zeros(columns.shape[1] + 1)
        cost[-1] = 1.0
        bounds = [(None, None)] * columns.shape[1] + [(0, None)]
        found = optimize.linprog(cost, rows, limits, bounds=bounds)
        if found.x is None:
            raise InvalidInputError(f"the linear programme has no answer: {found.message}")
        theta[heard] = found.x[:-1]
    return theta, int((~heard).sum())


def _sampled(inputs: tuple[Input, ...], target: Target, samples: int) -> tuple[Numbers, Numbers]:
    if callable(target):
        x = np.ascontiguousarray(spread(inputs, samples))
        y = _numbers(target(x))
    else:
        x, y = np.ascontiguousarray(_numbers(target[0])), _numbers(target[1])
    if x.ndim != 2 or x.shape[1] != len(inputs) or y.shape != x.shape[:1] or not len(y):
        wanted = f"(n, {len(inputs)}) inputs and (n,) values, n from 1"
        raise InvalidInputError(f"inputs of shape {x.shape} and values of shape {y.shape}; valid: {wanted}")
    if not (np.isfinite(x).all() and np.isfinite(y).all()):
        raise InvalidInputError("inputs or values that are not finite")
    return x, y


def _numbers(values: ArrayLike) -> Numbers:
    try:
        return np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InvalidInputError(f"no table of numbers: {error}") from error


def _measured(system: FuzzySystem, target: Target, x: Numbers, y: Numbers, samples: int, silent: int) -> Approximation:
    if callable(target):
        x, y = _sampled(system.inputs, target, 4 * samples)
    error = compile_system(system).batch(x)[:, 0] - y
    return Approximation(system, float(np.sqrt(np.mean(error**2))), float(np.abs(error).max()), silent)
