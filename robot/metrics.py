"""Figures of merit of a run, as control engineering defines them, for every coordinate and the worst of them."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

SETTLING_BAND = 0.02
"""A coordinate has settled when it stays within this share of its step."""

FINAL_SHARE = 0.1
"""The steady-state error is the mean over this last share of the run."""


class Metrics(NamedTuple):
    """Figures of merit; smaller is better.

    Each is a dict from ``s1 .. sN, theta1 .. thetaN`` (forces: ``F11, F21, F12, ...``) to a number, with the largest
    of them as ``worst``. NaN means not defined, infinity never reached; ``worst`` leaves out what is not defined.

    Errors are relative to the size |A| of the coordinate's motion, so that metres and radians compare: y = (q - q0)/A
    and e/|A|. A coordinate that is not asked to move is measured in units of the standard step, and has no overshoot,
    rise, settling or steady-state error; neither has any coordinate under a sinus.

    Attributes:
        overshoot: 100 · max(0, max y - 1), %.
        rise_time: From the first y = 0.1 to the first y = 0.9, s.
        settling_time: After which |y - 1| stays within 2 %, s.
        steady_state_error: |mean of e/|A| over the last tenth of the run|, %.
        iae: ∫ |e/A| dt, s.
        ise: ∫ (e/A)² dt, s.
        itae: ∫ t |e/A| dt, s².
        rms_error: √(mean of (e/A)² over time), %.
        effort: ∫ F² dt of each actuator, N² s.
        peak_force: max |F| of each actuator, N.
        saturation: Share of the time that an actuator is at its limit, %; 0 without limits.
    """

    overshoot: dict[str, float]
    rise_time: dict[str, float]
    settling_time: dict[str, float]
    steady_state_error: dict[str, float]
    iae: dict[str, float]
    ise: dict[str, float]
    itae: dict[str, float]
    rms_error: dict[str, float]
    effort: dict[str, float]
    peak_force: dict[str, float]
    saturation: dict[str, float]

    def to_dict(self) -> dict[str, dict[str, float | None]]:
        """Return plain dicts for JSON; what is not finite is None."""
        return {
            name: {key: value if math.isfinite(value) else None for key, value in getattr(self, name).items()}
            for name in self._fields
        }


def measure(
    t: Array,
    q: Array,
    reference: Array,
    forces: Array,
    start: Array,
    amplitude: Array,
    scale: Array,
    *,
    constant: bool,
    force_limits: tuple[float, float] | None,
) -> Metrics:
    """Measure a response.

    Args:
        t: (n,) s, ascending.
        q: (n, 2N) position.
        reference: (n, 2N) qd.
        forces: (n, 2N) actuator forces, N.
        start: (2N,) q0.
        amplitude: (2N,) A with its sign; 0 where no motion is asked for.
        scale: (2N,) what errors are divided by, greater than 0.
        constant: Whether the reference is a step.
        force_limits: Least and greatest force, N, or None.
    """
    size = q.shape[1]
    modules = range(1, size // 2 + 1)
    coordinates = [f"s{i}" for i in modules] + [f"theta{i}" for i in modules]
    actuators = [f"F{a}{i}" for i in modules for a in (1, 2)]
    nothing = [math.nan] * size
    if not len(t):
        return Metrics(*(_named(coordinates, nothing) for _ in range(8)), *(_named(actuators, nothing) for _ in "fps"))
    e = (reference - q) / scale
    overshoots, rises, settlings, finals = nothing.copy(), nothing.copy(), nothing.copy(), nothing.copy()
    if constant:
        for i in np.flatnonzero(amplitude):
            y = (q[:, i] - start[i]) / amplitude[i]
            overshoots[i] = overshoot(y)
            rises[i] = rise_time(t, y)
            settlings[i] = settling_time(t, y)
            finals[i] = 100.0 * abs(float(e[t >= t[-1] - FINAL_SHARE * (t[-1] - t[0]), i].mean()))
    length = float(t[-1] - t[0])
    squares = np.trapezoid(e**2, t, axis=0)
    saturated = np.zeros(size)
    if force_limits is not None:
        saturated = ((forces <= force_limits[0]) | (forces >= force_limits[1])).mean(axis=0)
    return Metrics(
        overshoot=_named(coordinates, overshoots),
        rise_time=_named(coordinates, rises),
        settling_time=_named(coordinates, settlings),
        steady_state_error=_named(coordinates, finals),
        iae=_named(coordinates, np.trapezoid(np.abs(e), t, axis=0)),
        ise=_named(coordinates, squares),
        itae=_named(coordinates, np.trapezoid(t[:, np.newaxis] * np.abs(e), t, axis=0)),
        rms_error=_named(coordinates, 100.0 * np.sqrt(squares / length) if length else 100.0 * np.abs(e[0])),
        effort=_named(actuators, np.trapezoid(forces**2, t, axis=0)),
        peak_force=_named(actuators, np.abs(forces).max(axis=0)),
        saturation=_named(actuators, 100.0 * saturated),
    )


def overshoot(y: Array) -> float:
    """Return by how many per cent a response y (n,) from 0 to 1 exceeds 1."""
    return 100.0 * max(0.0, float(y.max()) - 1.0)


def rise_time(t: Array, y: Array) -> float:
    """Return the time from the first y = 0.1 to the first y = 0.9, interpolated; infinite if it never rises."""
    high = _first_crossing(t, y, 0.9)
    return high - _first_crossing(t, y, 0.1) if math.isfinite(high) else math.inf


def settling_time(t: Array, y: Array, band: float = SETTLING_BAND) -> float:
    """Return the time from t[0] after which |y - 1| stays within ``band``, interpolated; infinite if it never does."""
    distance = np.abs(y - 1.0)
    outside = np.flatnonzero(distance > band)
    if not outside.size:
        return 0.0
    k = int(outside[-1])
    if k == len(t) - 1:
        return math.inf
    share = (distance[k] - band) / (distance[k] - distance[k + 1])
    return float(t[k] + share * (t[k + 1] - t[k]) - t[0])


def _first_crossing(t: Array, y: Array, level: float) -> float:
    above = np.flatnonzero(y >= level)
    if not above.size:
        return math.inf
    k = int(above[0])
    if k == 0:
        return float(t[0])
    return float(t[k - 1] + (level - y[k - 1]) / (y[k] - y[k - 1]) * (t[k] - t[k - 1]))


def _named(names: list[str], values: ArrayLike) -> dict[str, float]:
    named = {name: float(value) for name, value in zip(names, np.asarray(values, dtype=np.float64), strict=True)}
    defined = [value for value in named.values() if not math.isnan(value)]
    return {**named, "worst": max(defined, default=math.nan)}
