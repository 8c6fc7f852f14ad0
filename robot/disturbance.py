"""Disturbances of the arm: noise, seeded and repeatable bit for bit, pulses and pushes."""

from __future__ import annotations

import math
import numbers
from collections.abc import Iterator, Sequence
from typing import Literal

import msgspec
import numpy as np
from numpy.typing import NDArray

from robot.errors import InvalidScenarioError
from robot.kernels import control

Array = NDArray[np.float64]

BLOCK = 1024
"""Samples that are drawn at once."""


Channel = Literal["force", "measurement", "reference"]
"""What noise acts on: the generalized forces, the positions that the controller measures, or its target."""

CHANNELS: dict[Channel, int] = {
    "force": control.ON_FORCE,
    "measurement": control.ON_MEASUREMENT,
    "reference": control.ON_REFERENCE,
}
"""All channels and the kernels' codes for them."""


class BandLimitedNoise(msgspec.Struct, frozen=True):
    """White noise of limited bandwidth: a normal sample, held, then the next.

    Every coordinate has its own samples N(0, σ²), σ² = share · (size of the signal)², the "30 % of the power of the
    input signal". On forces that is the force which holds the coordinate at the target, on measurement and reference
    the size of its motion. In Simulink's block of this name σ² = noise power / hold time.

    Attributes:
        share: Of the signal's power, 0 to 100.
        hold_time: How long a sample holds, s; rounded to whole control steps.
        seed: Of the random generator; equal seeds give equal disturbances.
        channel: ``force``, ``measurement`` (of positions; velocities stay true) or ``reference``.

    Raises:
        InvalidScenarioError: Values outside these ranges.
    """

    share: float = 0.3
    hold_time: float = 0.036
    seed: int = 0
    channel: Channel = "force"

    def __post_init__(self) -> None:
        _within(self.share, 0.0, 100.0, "disturbance.share")
        _within(self.hold_time, 0.001, 600.0, "disturbance.hold_time")
        if isinstance(self.seed, bool) or not isinstance(self.seed, numbers.Integral) or self.seed < 0:
            raise InvalidScenarioError(f"found {self.seed!r}; valid: a whole number, 0 or more", "disturbance.seed")
        if self.channel not in CHANNELS:
            found = f"found {self.channel!r}; valid: {', '.join(CHANNELS)}"
            raise InvalidScenarioError(found, "disturbance.channel")

    def samples(self, size: Array) -> Iterator[Array]:
        """Yield blocks (BLOCK, 2N) of samples without end.

        Args:
            size: (2N,) of the signal: G(target), N and N m, or the motion, m and rad.
        """
        generator = np.random.default_rng(int(self.seed))
        deviation = math.sqrt(self.share) * np.abs(size)
        while True:
            yield generator.standard_normal((BLOCK, deviation.size)) * deviation


class Pulse(msgspec.Struct, frozen=True):
    """A generalized force on one coordinate for some time.

    Attributes:
        coordinate: Its name, such as ``theta2``.
        value: N on an s, N m on a θ; at most 10 000.
        start: s, 0 to 600.
        duration: s, 0.001 to 600; both are rounded to whole control steps.
    """

    coordinate: str
    value: float
    start: float
    duration: float

    def __post_init__(self) -> None:
        _within(self.value, -1e4, 1e4, "pulses.value")
        _within(self.start, 0.0, 600.0, "pulses.start")
        _within(self.duration, 0.001, 600.0, "pulses.duration")


class Push(msgspec.Struct, frozen=True):
    """A force on a point of the arm for some time.

    Attributes:
        force: Along n1 (horizontal) and n3 (down), N; at most 10 000 each.
        start: s, 0 to 600.
        duration: s, 0.001 to 600; both are rounded to whole control steps.
        point: Where, in modules from the base: 1 is the first rod, 2.5 the middle of the third module. None is the
            last rod.
    """

    force: tuple[float, float]
    start: float
    duration: float
    point: float | None = None

    def __post_init__(self) -> None:
        if len(self.force) != 2:
            raise InvalidScenarioError(f"found {self.force!r}; valid: two numbers", "pushes.force")
        for value in self.force:
            _within(value, -1e4, 1e4, "pushes.force")
        _within(self.start, 0.0, 600.0, "pushes.start")
        _within(self.duration, 0.001, 600.0, "pushes.duration")
        if self.point is not None:
            _within(self.point, 0.0, 8.0, "pushes.point")


def events(pulses: Sequence[Pulse], pushes: Sequence[Push], coordinates: Sequence[str], step: float) -> control.Events:
    """Return pulses and pushes as the kernel reads them.

    A point inside a module moves as its ends do, in proportion to the distances: a force on it is one on each end.

    Args:
        pulses: Pulses on coordinates.
        pushes: Pushes of points.
        coordinates: Names of the 2N coordinates.
        step: Control step, s.

    Raises:
        InvalidScenarioError: A coordinate or a point that the arm does not have.
    """
    size = len(coordinates)
    n = size // 2
    count = len(pulses) + len(pushes)
    ticks = np.zeros((count, 2), dtype=np.int64)
    force = np.zeros((count, size))
    load = np.zeros((count, n, 2))
    for i, event in enumerate((*pulses, *pushes)):
        first = round(event.start / step)
        ticks[i] = first, first + max(1, round(event.duration / step))
    for i, pulse in enumerate(pulses):
        if pulse.coordinate not in coordinates:
            found = f"found {pulse.coordinate!r}; valid: {', '.join(coordinates)}"
            raise InvalidScenarioError(found, f"pulses[{i}].coordinate")
        force[i, coordinates.index(pulse.coordinate)] = pulse.value
    for i, push in enumerate(pushes):
        point = float(n) if push.point is None else push.point
        if point > n:
            raise InvalidScenarioError(f"found {point:g}; valid: 0 to {n}", f"pushes[{i}].point")
        module = min(int(point), n - 1)
        share = point - module
        load[len(pulses) + i, module] = np.multiply(push.force, share)
        if module > 0:
            load[len(pulses) + i, module - 1] = np.multiply(push.force, 1.0 - share)
    return control.Events(ticks, force, load)


def _within(value: object, low: float, high: float, path: str) -> None:
    if isinstance(value, bool) or not isinstance(value, numbers.Real) or not low <= float(value) <= high:
        raise InvalidScenarioError(f"found {value!r}; valid: {low:g} to {high:g}", path)
