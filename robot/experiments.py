"""The paper's experiments, calibrated, and a study of robustness.

The paper prints no parameters: its figures can be met by choosing what it leaves out, which is a calibration and proves
nothing. What was chosen stands in :data:`CALIBRATION`; docs/reproduction.md says why.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Literal, NamedTuple

import msgspec
import numpy as np

from robot import controllers
from robot.arm import Arm
from robot.batch import batch_simulate
from robot.controllers import ControlLaw
from robot.controllers import pid as pid_gains
from robot.controllers.fuzzy import ERROR_GAIN, OUTPUT_GAIN, RATE_GAIN
from robot.controllers.fuzzy import Controller as FuzzyController
from robot.disturbance import BandLimitedNoise
from robot.errors import RobotError
from robot.robustness import percentile, random_arms, study
from robot.run import Run
from robot.scenario import Scenario
from robot.simulation import simulate

Case = Literal["clean", "noisy"]
Variant = Literal["raw", "feasible"]
Progress = Callable[[float], None]
"""Receives the share that is done, 0 to 1."""

CASES: tuple[Case, ...] = ("clean", "noisy")
VARIANTS: tuple[Variant, ...] = ("raw", "feasible")

CONTROLLERS = ("pid", "fuzzy_flc", "pd_flc")
"""The paper's PID and its proposed controller, and what is left of that without its fuzzy blocks."""

PAPER: dict[tuple[Case, str], float] = {
    ("clean", "pid"): 2.8,
    ("clean", "fuzzy_flc"): 0.0,
    ("noisy", "pid"): 16.0,
    ("noisy", "fuzzy_flc"): 2.3,
}
"""The overshoots that the paper prints, %."""


class Calibration(msgspec.Struct, frozen=True):
    """What was chosen where the paper is silent. The feasible variant differs by its last two values alone."""

    arm: str = "soft"
    overshoot: str = "100 max(0, max y - 1) %, y = (q - q0) / (target - q0) on the true state over 3 s"
    coordinate: str = "s1"
    step_extension_m: float = 0.03
    step_bend_rad: float = 0.3
    disturbance: str = "a normal sample, held, on every generalized force; its variance is share x (holding force)^2"
    noise_share: float = 0.3
    noise_hold_time_s: float = 0.036
    pid: str = "(Kp, Kd, Ki) = factors x diag dG/dq at the start"
    pid_factors: tuple[float, float, float] = (pid_gains.PROPORTIONAL, pid_gains.DERIVATIVE, pid_gains.INTEGRAL)
    natural_frequency_rad_s: float = 217.0
    damping_ratio: float = 1.0
    fuzzy_blocks: str = "GU = factor wn^2 A, GE = factor / A, GC = factor / (A wn), A the step; no integral"
    fuzzy_factors: tuple[float, float, float] = (OUTPUT_GAIN, ERROR_GAIN, RATE_GAIN)
    rule_base: str = "piltan"
    feasible_prefilter_rad_s: float = 12.0
    feasible_force_limit_n: float = 60.0


CALIBRATION = Calibration()
"""The values with which the paper's figures are met."""

SINUS_FREQUENCY = 0.5
"""Hz, of the paper's sinus, which it does not print."""


class Overshoots(NamedTuple):
    """Overshoots of one controller in one experiment, over the seeds.

    Attributes:
        case: Without or with disturbance.
        variant: ``raw`` is a step without limits, as the paper simulates; ``feasible`` has a prefilter and limits.
        controller: Name of the control law.
        mean: %.
        p5: 5th percentile, %.
        p95: 95th percentile, %.
        peak_force: Largest actuator force, N.
        paper: What the paper prints, %; None where it prints nothing.
    """

    case: Case
    variant: Variant
    controller: str
    mean: float
    p5: float
    p95: float
    peak_force: float
    paper: float | None


class Robustness(NamedTuple):
    """What one controller makes of arms other than the one it knows; the worst coordinate of every arm counts.

    Attributes:
        controller: Name of the control law.
        overshoot_median: %.
        overshoot_p95: %.
        error_median: Steady-state error, %.
        error_p95: %.
        stopped: Share of the arms that ran away, %.
    """

    controller: str
    overshoot_median: float
    overshoot_p95: float
    error_median: float
    error_p95: float
    stopped: float


def arm() -> Arm:
    """Return the arm of the experiments."""
    return Arm.preset(CALIBRATION.arm)


def law(name: str, inference: FuzzyController) -> ControlLaw:
    """Return a control law of the experiments; the fuzzy ones use the rule base ``inference``."""
    return controllers.default(
        name,
        arm(),
        Scenario.preset("step"),
        inference,
        natural_frequency=CALIBRATION.natural_frequency_rad_s,
        damping_ratio=CALIBRATION.damping_ratio,
    )


def scenario(case: Case, variant: Variant, seed: int = 0) -> Scenario:
    """Return the step of an experiment."""
    step = Scenario.preset("step")
    if case == "noisy":
        noise = BandLimitedNoise(CALIBRATION.noise_share, CALIBRATION.noise_hold_time_s, seed)
        step = msgspec.structs.replace(step, disturbance=noise)
    if variant == "feasible":
        limit = CALIBRATION.feasible_force_limit_n
        prefilter = CALIBRATION.feasible_prefilter_rad_s
        step = msgspec.structs.replace(step, prefilter=prefilter, force_limits=(-limit, limit))
    return step


def overshoots(inference: FuzzyController, seeds: int = 100, progress: Progress | None = None) -> list[Overshoots]:
    """Return the paper's table: every case, variant and controller, noise with seeds 0, 1, ...

    Raises:
        RobotError: No seed, or more than 100 000.
    """
    if not 1 <= seeds <= 100_000:
        raise RobotError(f"found {seeds}; valid: 1 to 100000", "seeds")
    coordinate = arm().coordinates.index(CALIBRATION.coordinate)
    rows = []
    experiments: list[tuple[Case, Variant, str]] = [
        (case, variant, name) for case in CASES for variant in VARIANTS for name in CONTROLLERS
    ]
    for number, (case, variant, name) in enumerate(experiments):
        asked = [scenario(case, variant, seed) for seed in range(seeds if case == "noisy" else 1)]
        figures = batch_simulate(arm(), law(name, inference), asked, progress=_part(progress, number, experiments))
        values = figures.overshoot[:, coordinate]
        low, high = np.percentile(values, [5, 95])
        peak = float(figures.peak_force.max())
        paper = PAPER.get((case, name))
        rows.append(Overshoots(case, variant, name, float(values.mean()), float(low), float(high), peak, paper))
    return rows


def example(name: str, case: Case, variant: Variant, inference: FuzzyController, seed: int = 0) -> Run:
    """Return one run of the table, whole."""
    return simulate(arm(), law(name, inference), scenario(case, variant, seed))


def sinus(name: str, inference: FuzzyController) -> Run:
    """Return the answer to a sinus of ``SINUS_FREQUENCY``."""
    return simulate(arm(), law(name, inference), Scenario.preset("sinus"))


def robustness(
    inference: FuzzyController,
    plants: int = 1000,
    names: Sequence[str] = controllers.NAMES,
    progress: Progress | None = None,
) -> list[Robustness]:
    """Return how every controller does the feasible step on random arms, ± 30 %, that it does not know.

    Raises:
        RobotError: No arm, or more than 100 000.
    """
    if not 1 <= plants <= 100_000:
        raise RobotError(f"found {plants}; valid: 1 to 100000", "plants")
    arms = random_arms(arm(), plants)
    rows = []
    for number, name in enumerate(names):
        step = scenario("clean", "feasible")
        found = study(arms, law(name, inference), step, progress=_part(progress, number, names, plants))
        values = [percentile(x, p) for x in (found.overshoot, found.steady_state_error) for p in (50, 95)]
        rows.append(Robustness(name, *values, stopped=100.0 * float(found.stopped.mean())))
    return rows


def _part(
    progress: Progress | None, number: int, parts: Sequence[object], runs: int | None = None
) -> Callable[[int], None] | None:
    """Return what a batch calls with its finished runs while it is one of several parts."""
    if progress is None:
        return None
    return lambda done: progress((number + (done / runs if runs else 0.0)) / len(parts))
