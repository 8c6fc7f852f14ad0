"""Disturbances of the arm: seeded and repeatable bit for bit."""

from __future__ import annotations

import math
import numbers
from collections.abc import Iterator

import msgspec
import numpy as np
from numpy.typing import NDArray

from robot.errors import InvalidScenarioError

Array = NDArray[np.float64]

BLOCK = 1024
"""Samples that are drawn at once."""


class BandLimitedNoise(msgspec.Struct, frozen=True):
    """White noise of limited bandwidth on the generalized forces: a normal sample, held, then the next.

    Every coordinate has its own samples N(0, σ²), σ² = share · (force that holds the coordinate at the target)², the
    "30 % of the power of the input signal". In Simulink's block of this name σ² = noise power / hold time.

    Attributes:
        share: Of the holding force's power, 0 to 100.
        hold_time: How long a sample holds, s; rounded to whole control steps.
        seed: Of the random generator; equal seeds give equal disturbances.

    Raises:
        InvalidScenarioError: Values outside these ranges.
    """

    share: float = 0.3
    hold_time: float = 0.036
    seed: int = 0

    def __post_init__(self) -> None:
        _within(self.share, 0.0, 100.0, "disturbance.share")
        _within(self.hold_time, 0.001, 600.0, "disturbance.hold_time")
        if isinstance(self.seed, bool) or not isinstance(self.seed, numbers.Integral) or self.seed < 0:
            raise InvalidScenarioError(f"found {self.seed!r}; valid: a whole number, 0 or more", "disturbance.seed")

    def samples(self, holding_force: Array) -> Iterator[Array]:
        """Yield blocks (BLOCK, 2N) of samples without end.

        Args:
            holding_force: (2N,) G(target), N and N m.
        """
        generator = np.random.default_rng(int(self.seed))
        deviation = math.sqrt(self.share) * np.abs(holding_force)
        while True:
            yield generator.standard_normal((BLOCK, deviation.size)) * deviation


def _within(value: object, low: float, high: float, path: str) -> None:
    if isinstance(value, bool) or not isinstance(value, numbers.Real) or not low <= float(value) <= high:
        raise InvalidScenarioError(f"found {value!r}; valid: {low:g} to {high:g}", path)
