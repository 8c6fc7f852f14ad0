"""Where a response overshoots, and while what was done about it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from robot.run import Run
from robot.scenario import Step

LEAST = 0.5
"""Overshoot from which on it is worth a word, %."""

_NEARLY = 0.98
"""Share of the largest excess that counts as the peak."""

_APPROACH = 0.5
"""Share of the step from which on the arm should be braking."""


class Overshoot(NamedTuple):
    """How one coordinate goes beyond its target.

    Attributes:
        coordinate: Its number.
        percent: Of the step, %.
        first: Row at which half of the way is made: from here on braking could have helped.
        peak: Row at which the excess is practically at its largest.
        direction: 1 for a step upwards, -1 for one downwards.
    """

    coordinate: int
    percent: float
    first: int
    peak: int
    direction: int


def overshoots(run: Run, least: float = LEAST) -> tuple[Overshoot, ...]:
    """Return the overshoots of a step response, the largest first; none for any other motion.

    Args:
        run: The run.
        least: Smallest overshoot that counts, %.
    """
    if not isinstance(run.scenario.reference, Step) or not len(run.t):
        return ()
    amplitude = run.scenario.amplitude(run.arm.n_modules)
    found = []
    for i in np.flatnonzero(amplitude):
        y = (run.q[:, i] - run.start[i]) / amplitude[i]
        percent = 100.0 * (float(y.max()) - 1.0)
        if percent > least:
            # One that creeps towards its largest excess has reached it when nearly all of it is there.
            peak = int(np.argmax(y >= 1.0 + _NEARLY * percent / 100.0))
            first = int(np.argmax(y >= _APPROACH))
            found.append(Overshoot(int(i), percent, first, peak, int(np.sign(amplitude[i]))))
    return tuple(sorted(found, key=lambda one: -one.percent))
