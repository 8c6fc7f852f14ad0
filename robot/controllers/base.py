"""What every control law is to the simulation: gains at the level of accelerations and of forces.

``Law`` is compiled into the kernels (``fuzzy.kernels.jit``).
"""

from __future__ import annotations

import math
import numbers
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from robot.errors import InvalidControllerError

Array = NDArray[np.float64]

STEP = 0.001
"""Control step, s: controllers act at 1 kHz, and their forces hold until the next step."""

ACCELERATION = 0
"""Row of the gains that act inside the feedback linearization, on q̈."""

FORCE = 1
"""Row of the gains that act on the generalized forces directly."""

MODEL_FREE = 0
LINEARIZING = 1
GRAVITY = 2
"""What the controller's model adds to Q: nothing; the inverse dynamics; springs, gravity and Coulomb friction."""

NO_BLOCKS = 0
ADDED = 1
SCALING = 2
ADAPTED_SETS = 3
ADAPTED_GAUSSIANS = 4
"""What the fuzzy blocks do: nothing; add to the law; multiply its gains; add what they learn, on the edited sets or
on Gaussian ones."""


class Law(NamedTuple):
    """A control law as the kernel reads it; every law of this package is one choice of these arrays.

    With e = qd - q and T the fuzzy block's output divided by its largest value:

        v = q̈d + Kp e + Kd ė + Ki ∫e dt + GU T                        (row ACCELERATION of the gains)
        Q = [D̂ v + Ĉ q̇ + B̂ q̇ + F̂ + Ĝ]  +  Kp e + Kd ė + Ki ∫e dt + GU T   (row FORCE; brackets if LINEARIZING)

    GRAVITY puts F̂ + Ĝ in the brackets. SCALING blocks multiply: (Kp e + Kd ė + Ki ∫e dt) (1 + GU |T|). Adapted blocks
    give T = θᵀ ξ(GE e, GC ė) with dθ/dt = ξ (adaptation[0] e + adaptation[1] ė) - leak θ; equations (39)-(43).
    """

    model: int
    """MODEL_FREE, LINEARIZING or GRAVITY."""
    fuzzy: int
    """NO_BLOCKS, ADDED, SCALING, ADAPTED_SETS or ADAPTED_GAUSSIANS; one block a coordinate."""
    Kp: Array
    """(2, 2N) 1/s² and N/m or N m/rad."""
    Kd: Array
    """(2, 2N) 1/s and N s/m or N m s/rad."""
    Ki: Array
    """(2, 2N) 1/s³ and N/(m s) or N m/(rad s)."""
    GU: Array
    """(2, 2N) m/s² or rad/s², and N or N m."""
    scale: Array
    """(2N, 2) GE and GC: inputs of the fuzzy block for one unit of e and of ė."""
    output_scale: float
    """1 / T_max."""
    band: Array
    """(2N,) the integral acts where |e| is at most this; m or rad."""
    adaptation: Array
    """(2, 2N) rates γ p12 and γ p22 of the adapted blocks."""
    leak: Array
    """(2N,) σ of the adapted blocks, 1/s."""


def law(
    *,
    size: int,
    linearizing: bool,
    Kp: Sequence[float],
    Kd: Sequence[float],
    Ki: Sequence[float] | None = None,
    GU: Sequence[float] | None = None,
    scale: Sequence[Sequence[float]] | None = None,
    output_scale: float = 0.0,
    band: Sequence[float] | None = None,
    blocks: int = ADDED,
    adaptation: Sequence[Sequence[float]] | None = None,
    leak: Sequence[float] | None = None,
) -> Law:
    """Return a law whose gains all act at one level: on accelerations if linearizing, otherwise on forces."""
    level = ACCELERATION if linearizing else FORCE

    def rows(gains: Sequence[float] | None) -> Array:
        array = np.zeros((2, size))
        if gains is not None:
            array[level] = gains
        return array

    return Law(
        model=LINEARIZING if linearizing else MODEL_FREE,
        fuzzy=NO_BLOCKS if scale is None else blocks,
        Kp=rows(Kp),
        Kd=rows(Kd),
        Ki=rows(Ki),
        GU=rows(GU),
        scale=np.zeros((size, 2)) if scale is None else np.array(scale, dtype=np.float64),
        output_scale=float(output_scale),
        band=np.full(size, np.inf) if band is None else np.array(band, dtype=np.float64),
        adaptation=np.zeros((2, size)) if adaptation is None else np.array(adaptation, dtype=np.float64),
        leak=np.zeros(size) if leak is None else np.array(leak, dtype=np.float64),
    )


def keep_checked(struct: msgspec.Struct, names: Iterable[str], size: int | None) -> None:
    """Check the gains of a law (see :func:`checked_gains`) and keep them as tuples; only ``band`` may be infinite."""
    for name in names:
        gains = checked_gains(getattr(struct, name), size, name, infinite=name == "band")
        msgspec.structs.force_setattr(struct, name, gains)


def checked_gains(values: object, size: int | None, name: str, *, infinite: bool = False) -> tuple[float, ...]:
    """Return one finite number, 0 or more, for each coordinate.

    Args:
        values: A sequence of numbers, or one number for all coordinates when ``size`` is known.
        size: Number of coordinates 2N, or None for any even number.
        name: Name of the gain, for the error.
        infinite: Whether infinity is a valid value.

    Raises:
        InvalidControllerError: Wrong number of values, or one that is negative or not a number.
    """
    if isinstance(values, numbers.Real) and size is not None:
        values = (values,) * size
    if isinstance(values, str | bytes) or not isinstance(values, Iterable):
        raise InvalidControllerError(f"found {values!r}; valid: a sequence of numbers, one a coordinate", name)
    gains = []
    for i, value in enumerate(values):
        if isinstance(value, bool) or not isinstance(value, numbers.Real):
            raise InvalidControllerError(f"found {value!r}; valid: a number", f"{name}[{i}]")
        gain = float(value)
        if math.isnan(gain) or gain < 0.0 or (math.isinf(gain) and not infinite):
            raise InvalidControllerError(f"found {gain:g}; valid: a finite number, 0 or more", f"{name}[{i}]")
        gains.append(gain)
    if size is None and (not gains or len(gains) % 2):
        raise InvalidControllerError(f"found {len(gains)} values; valid: an even number, s before theta", name)
    if size is not None and len(gains) != size:
        raise InvalidControllerError(f"found {len(gains)} values; valid: {size}, one a coordinate", name)
    return tuple(gains)
