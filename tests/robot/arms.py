"""Arms and states for the tests: presets, and arbitrary ones that no symmetry can flatter."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from robot.arm import Arm


def uneven_arm(n: int = 3, seed: int = 0, damping: bool = True) -> Arm:
    """Every module and both its actuators differ."""
    rng = np.random.default_rng(seed)
    return Arm(
        mass=rng.uniform(0.1, 0.4, n).tolist(),
        inertia=rng.uniform(2e-4, 8e-4, n).tolist(),
        rod_length=rng.uniform(0.05, 0.1, n).tolist(),
        rest_length=rng.uniform(0.08, 0.14, n).tolist(),
        stiffness=rng.uniform(150, 400, (2, n)).tolist(),
        damping=(rng.uniform(2, 6, (2, n)) * damping).tolist(),
        gravity=9.81,
    )


def random_state(n: int = 3, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    q = np.concatenate([rng.uniform(0.05, 0.2, n), rng.uniform(-1.2, 1.2, n)])
    return q, rng.normal(size=2 * n)


@st.composite
def states(draw: st.DrawFn, n: int = 3) -> tuple[np.ndarray, np.ndarray]:
    """Positions with lengths down to 0 and any angles, and velocities."""
    length, angle, rate = st.floats(0.0, 0.3), st.floats(-3.0, 3.0), st.floats(-5.0, 5.0)
    q = [draw(length) for _ in range(n)] + [draw(angle) for _ in range(n)]
    return np.array(q), np.array([draw(rate) for _ in range(2 * n)])
