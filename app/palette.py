"""Colours: one diverging scale for values of outputs everywhere, and the roles of the runs."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fuzzy import partition
from fuzzy.identity import remembered
from fuzzy.system import Output, Variable

RGB = tuple[int, int, int]

_SCALE = np.array(
    [
        (38, 98, 217),
        (86, 143, 236),
        (158, 190, 246),
        (197, 200, 210),
        (247, 192, 140),
        (238, 140, 62),
        (214, 95, 14),
    ]
)
"""Blue - grey - orange, from the low end of a range to its high end."""

RUN = "#4f8ff7"
BEFORE = "#9fc0f9"
PID = "#f0964a"
KEPT: tuple[RGB, ...] = ((123, 216, 143), (199, 146, 234), (230, 207, 107), (244, 143, 177))
"""Of kept runs, by the number of their slot."""
COORDINATES: tuple[RGB, ...] = ((79, 143, 247), (57, 194, 201), (142, 209, 92), (240, 150, 74), (236, 110, 140),
                                (178, 130, 240), (220, 200, 90), (150, 170, 190))  # fmt: skip
"""Of coordinates or forces that share a picture, repeated when there are more."""
REFERENCE = "#a6abb8"
MUTED = "#8b909e"
TEXT = "#d9dce4"
GOOD = "#6fcf97"
BAD = "#f2b06c"
ERROR = "#ff8f85"
MARK = "#ffd75e"
GRID = "#33363d"
SURFACE = "#2b2d33"


@remembered(64)
def term_colors(variable: Variable) -> tuple[RGB, ...]:
    """Return the colours of a variable's terms.

    Those of an output say what it is worth: where in the range the set is largest, a constant is, or a function is for
    inputs 0; the middle of the range is grey. Those of an input differ as much as they can, in the terms' order.
    """
    if isinstance(variable, Output):
        shares = (np.array(partition.places(variable)) - variable.low) / (variable.high - variable.low)
    else:
        shares = np.linspace(0.0, 1.0, len(variable.terms)) if len(variable.terms) > 1 else np.array([0.5])
    return tuple((round(red), round(green), round(blue)) for red, green, blue in scale_colors(shares).tolist())


def linear(colors: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Return colours (n, 3) as linear light, as vertices and batched meshes want them: else they look pale."""
    return (255.0 * (colors / 255.0) ** 2.2).round().astype(np.uint8)


def scale_colors(shares: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the scale's colours (n, 3) at shares (n,) from 0 to 1."""
    place = (len(_SCALE) - 1) * shares
    channels = [np.interp(place, range(len(_SCALE)), _SCALE[:, channel]) for channel in range(3)]
    return np.stack(channels, axis=1)


def css(color: RGB, alpha: float = 1.0) -> str:
    """Return a colour in CSS."""
    return f"rgba({color[0]},{color[1]},{color[2]},{alpha:g})"


def ink(color: RGB) -> str:
    """Return the text colour that is legible on ``color``."""
    red, green, blue = color
    return "#10131a" if 0.299 * red + 0.587 * green + 0.114 * blue > 140 else "#ffffff"
