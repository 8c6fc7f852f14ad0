"""The named compositions of implication and aggregation, and what an implication makes of a set.

The formulas of all operators are those of :mod:`fuzzy.kernels.norms`; here they are by name.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzy import sets
from fuzzy.compiler.methods import IMPLICATION
from fuzzy.kernels import norms
from fuzzy.system import Aggregation, Implication, Term


class Composition(NamedTuple):
    """A pair of implication and aggregation.

    Attributes:
        implication: What a rule of strength w makes of its consequent's degree a.
        aggregation: How the implied sets are joined over all rules that fire.
        formula: Degree of the aggregated set; max, Σ and min run over the rules.
        equation: Number in the source paper; 0 for none.
    """

    implication: Implication
    aggregation: Aggregation
    formula: str
    equation: int = 0


COMPOSITIONS = {
    "Max-Min": Composition("min", "max", "max min(w, a)", 31),
    "Sum-Min": Composition("min", "sum", "Σ min(w, a)", 32),
    "Max-Product": Composition("product", "max", "max w a"),
    "Sum-Product": Composition("product", "sum", "Σ w a"),
    "Max-Bounded product": Composition("bounded_difference", "max", "max max(0, w + a - 1)"),
    "Max-Drastic product": Composition("drastic_product", "max", "max (a if w = 1, w if a = 1, otherwise 0)"),
    "Max-Bounded sum": Composition("bounded_sum", "max", "max min(1, w + a)"),
    "Max-Algebraic sum": Composition("algebraic_sum", "max", "max (w + a - w a)"),
    "Min-Max": Composition("kleene_dienes", "min", "min max(1 - w, a)"),
}
"""The source paper's seven compositions, Max-Product and Sum-Product, by name."""


def implied(term: Term, implication: Implication, strength: float, u: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the degrees of a consequent's implied set, to be drawn.

    Args:
        term: The consequent's term, a set.
        implication: The system's implication.
        strength: Firing strength w of the rule, in [0, 1]; 0 implies nothing.
        u: (m,) places in the output's universe.

    Returns:
        (m,) degrees.
    """
    degree = sets.degrees(term, u)
    if strength > 0.0:
        norms.imply(IMPLICATION[implication], strength, degree)
    else:
        degree[:] = 0.0
    return degree
