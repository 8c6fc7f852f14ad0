"""What a control law makes of arms other than the one that it knows: many random arms, the same task."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from robot.arm import Arm, parameters
from robot.batch import BatchMetrics, batch_simulate
from robot.controllers import ControlLaw
from robot.scenario import Scenario

Array = NDArray[np.float64]

SPREAD = 0.3
"""By how much every mass, inertia, spring and damper may be off, as a share of itself."""

_VARIED = ("mass", "inertia", "stiffness", "damping")


class Spread(NamedTuple):
    """Figures of merit on many arms, in each the worst coordinate's; infinite where an arm ran away.

    Attributes:
        overshoot: (n,) %; NaN where the task has no step.
        settling_time: (n,) s; infinite where an arm never settles.
        steady_state_error: (n,) %.
        rms_error: (n,) %.
        stopped: (n,) whether the arm ran away.
    """

    overshoot: Array
    settling_time: Array
    steady_state_error: Array
    rms_error: Array
    stopped: NDArray[np.bool_]


def random_arms(nominal: Arm, count: int, spread: float = SPREAD, seed: int = 0) -> list[Arm]:
    """Return arms of which every mass, inertia, spring and damper is off by up to ± ``spread``, uniformly."""
    generator = np.random.default_rng(seed)
    known = parameters(nominal)

    def varied(values: Array) -> Array:
        return values * generator.uniform(1.0 - spread, 1.0 + spread, values.shape)

    return [
        msgspec.structs.replace(nominal, **{name: varied(getattr(known, name)) for name in _VARIED})
        for _ in range(count)
    ]


def study(
    arms: Sequence[Arm],
    law: ControlLaw,
    scenario: Scenario,
    *,
    progress: Callable[[int], None] | None = None,
    workers: int | None = None,
) -> Spread:
    """Return how a control law does one scenario on many arms; it keeps its own model of the arm.

    Args:
        arms: The arms.
        law: The control law.
        scenario: What is asked of every arm.
        progress: Called in the caller's thread with the number of finished arms, now and then; what it raises ends
            the study.
        workers: Number of threads; by default that of the processor's cores.

    Raises:
        RobotError: No arm, or parts that do not fit each other.
    """
    return spread_of(batch_simulate(arms, law, scenario, progress=progress, workers=workers))


def spread_of(figures: BatchMetrics) -> Spread:
    """Return the worst coordinate's figures of every run; coordinates without a step are left out."""
    names = ("overshoot", "settling_time", "steady_state_error", "rms_error")
    return Spread(*(np.fmax.reduce(getattr(figures, name), axis=1) for name in names), stopped=figures.stopped)


def percentile(values: Array, percent: float) -> float:
    """Return the least value below which so many of all lie; there is no interpolation towards what is infinite."""
    return float(np.percentile(values, percent, method="higher"))


def histogram(samples: Sequence[Array], bins: int = 24) -> tuple[Array, list[NDArray[np.int64]]]:
    """Return common edges (bins + 1,) from 0 on and how many of each sample's values lie between them.

    What is not finite lies in no bin. The last edge is the largest finite value, at least 1e-9.
    """
    finite = [values[np.isfinite(values)] for values in samples]
    top = max((float(values.max()) for values in finite if values.size), default=0.0)
    edges = np.linspace(0.0, max(top, 1e-9), bins + 1)
    return edges, [np.histogram(values, edges)[0] for values in finite]
