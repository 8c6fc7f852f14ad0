"""Thousands of runs at once, of which only the figures of merit are kept."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robot.arm import Arm
from robot.controllers import ControlLaw
from robot.errors import RobotError
from robot.kernels import reduction
from robot.metrics import FINAL_SHARE, SETTLING_BAND
from robot.scenario import STEP, Scenario, Step
from robot.simulation import Simulation

Array = NDArray[np.float64]

_CHUNK = 250
"""Control steps between two reductions: their log stays in the processor's cache."""

_PORTION = 8
"""Most runs that a thread makes before it reports."""


class BatchMetrics(NamedTuple):
    """Figures of merit of every run and coordinate, as in :class:`robot.metrics.Metrics`; NaN where not defined.

    A run that was stopped has infinite figures: nothing bounds what it would have come to.

    Attributes:
        overshoot: (n, 2N) %.
        settling_time: (n, 2N) s, in whole control steps; infinite where a coordinate never settles.
        steady_state_error: (n, 2N) %.
        rms_error: (n, 2N) %.
        peak_force: (n, 2N) of every actuator, N.
        stopped: (n,) whether a run was stopped.
    """

    overshoot: Array
    settling_time: Array
    steady_state_error: Array
    rms_error: Array
    peak_force: Array
    stopped: NDArray[np.bool_]


def batch_simulate(
    arms: Arm | Sequence[Arm],
    controller: ControlLaw,
    scenarios: Scenario | Sequence[Scenario],
    *,
    progress: Callable[[int], None] | None = None,
    workers: int | None = None,
) -> BatchMetrics:
    """Simulate many runs in parallel.

    Every run is the one that :func:`robot.simulation.simulate` makes, bit for bit. The kernels release the
    interpreter's lock, so that plain threads use all cores; other than numba's, they may be started from any thread.

    Args:
        arms: The arms that are simulated, or one for all scenarios. The controller keeps its own model of the arm.
        controller: The control law of all runs.
        scenarios: One for every arm, or one for all; they may differ in everything, such as seeds and mismatches.
        progress: Called in the caller's thread with the number of finished runs, now and then.
        workers: Number of threads; by default that of the processor's cores.

    Raises:
        RobotError: Arms and scenarios in different numbers, or parts that do not fit each other.
    """
    plants = [arms] if isinstance(arms, Arm) else list(arms)
    asked = [scenarios] if isinstance(scenarios, Scenario) else list(scenarios)
    count = max(len(plants), len(asked))
    plants = plants * count if isinstance(arms, Arm) else plants
    asked = asked * count if isinstance(scenarios, Scenario) else asked
    if len(plants) != len(asked) or not count:
        raise RobotError(f"found {len(plants)} arms and {len(asked)} scenarios; valid: equal numbers, 1 or more")

    threads = workers or os.cpu_count() or 1
    size = max(1, min(_PORTION, count // (4 * threads)))

    def portion(first: int) -> list[tuple[Array, ...]]:
        last = min(first + size, count)
        return [_one(plants[i], controller, asked[i]) for i in range(first, last)]

    firsts = range(0, count, size)
    with ThreadPoolExecutor(threads) as pool:
        jobs = [pool.submit(portion, first) for first in firsts]
        try:
            pending = set(jobs)
            while pending:
                _, pending = wait(pending, return_when=FIRST_COMPLETED)
                if progress is not None:
                    progress(min(count, (len(jobs) - len(pending)) * size))
            rows = [row for job in jobs for row in job.result()]
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    columns = [np.stack(column) for column in zip(*rows, strict=True)]
    return BatchMetrics(*columns[:5], stopped=columns[5].astype(bool))


def _one(arm: Arm, controller: ControlLaw, scenario: Scenario) -> tuple[Array, ...]:
    """Return one run's row of every column."""
    simulation = Simulation(arm, controller, scenario, history=_CHUNK * STEP)
    n = arm.n_modules
    amplitude, scale = scenario.amplitude(n), scenario.scale(n)
    if not isinstance(scenario.reference, Step):
        amplitude = np.zeros(2 * n)
    steps = scenario.n_steps + 1
    final = round((1.0 - FINAL_SHARE) * scenario.n_steps)
    totals = reduction.Tally(np.full(2 * n, -np.inf), *(np.zeros(2 * n) for _ in range(4)))
    while simulation.tick < steps and simulation.stopped is None:
        first = simulation.tick
        made = simulation.advance(min(_CHUNK, steps - first))
        log = simulation.log
        reduction.tally(
            log.q,
            log.reference,
            log.forces,
            first,
            made,
            final,
            steps - 1,
            SETTLING_BAND,
            simulation.start,
            amplitude,
            scale,
            totals,
        )
    stopped = simulation.stopped is not None
    moving = amplitude != 0.0
    never = np.full(2 * n, np.inf)
    if stopped:
        figures = [np.where(moving, never, np.nan)] * 3 + [never] * 2
    else:
        settled = np.where(totals.unsettled < steps, totals.unsettled * STEP, np.inf)
        error = 100.0 * np.abs(totals.final) / (steps - final)
        figures = [
            np.where(moving, 100.0 * np.maximum(totals.peak - 1.0, 0.0), np.nan),
            np.where(moving, settled, np.nan),
            np.where(moving, error, np.nan),
            100.0 * np.sqrt(totals.square / (steps - 1)),
            totals.force,
        ]
    return (*figures, np.array(stopped))
