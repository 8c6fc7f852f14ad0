"""The set that a rule implies for its consequent, as a curve to be drawn; the kernels compute it point by point."""

from __future__ import annotations

from typing import assert_never

import numpy as np
from numpy.typing import NDArray

from fuzzy import sets
from fuzzy.system import Implication, Term

Array = NDArray[np.float64]


def implied(term: Term, implication: Implication, strength: float, u: Array) -> Array:
    """Return the degrees of a consequent's implied set.

    Args:
        term: The consequent's term, a set.
        implication: The system's implication.
        strength: Firing strength w of the rule, in [0, 1]; 0 implies nothing.
        u: (m,) places in the output's universe.

    Returns:
        (m,) degrees.
    """
    degree = sets.degrees(term, u)
    return _implied(implication, strength, degree) if strength > 0.0 else np.zeros(len(u))


def _implied(implication: Implication, w: float, degree: Array) -> Array:
    match implication:
        case "min":
            return np.minimum(w, degree)
        case "product":
            return w * degree
        case "bounded_difference":
            return np.maximum(0.0, w + degree - 1.0)
        case "drastic_product":
            return np.where(degree == 1.0, w, np.where(w == 1.0, degree, 0.0))
        case "einstein_product":
            return w * degree / (2.0 - (w + degree - w * degree))
        case "hamacher_product":
            both = w + degree - w * degree
            return np.where(both > 0.0, w * degree / np.where(both > 0.0, both, 1.0), 0.0)
        case "nilpotent_minimum":
            return np.where(w + degree > 1.0, np.minimum(w, degree), 0.0)
        case "bounded_sum":
            return np.minimum(1.0, w + degree)
        case "algebraic_sum":
            return w + degree - w * degree
        case "kleene_dienes":
            return np.maximum(1.0 - w, degree)
        case _:
            assert_never(implication)
