"""Terms that are nothing but a shape, for tests of shapes."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzy import sets
from fuzzy.shapes import Shape
from fuzzy.system import Term


def term(shape: Shape) -> Term:
    """Return a term of full height."""
    return Term("plain", shape)


def degrees(shape: Shape, x: ArrayLike) -> NDArray[np.float64]:
    """Return the degrees of a shape."""
    return sets.degrees(term(shape), x)
