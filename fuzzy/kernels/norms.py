"""Triangular norms and conorms, chosen by code; all of degrees in [0, 1].

The formulas are written so that T(a, 1) = a and S(a, 0) = a hold to the last bit, and that no small degree is lost in
a difference of numbers near 1.

References:
    Klement, Mesiar, Pap, "Triangular Norms", 2000; IEC 61131-7:2000 and IEEE 1855-2016 for the names.
"""

from fuzzy.kernels.jit import borrowing_kernel

MIN = 0
PRODUCT = 1
BOUNDED_DIFFERENCE = 2
DRASTIC_PRODUCT = 3
EINSTEIN_PRODUCT = 4
HAMACHER_PRODUCT = 5
NILPOTENT_MINIMUM = 6

MAX = 0
ALGEBRAIC_SUM = 1
BOUNDED_SUM = 2
DRASTIC_SUM = 3
EINSTEIN_SUM = 4
HAMACHER_SUM = 5
NILPOTENT_MAXIMUM = 6

SUM = 1
"""Aggregation by an unbounded sum; beside ``MAX``."""


@borrowing_kernel
def t_norm(code: int, a: float, b: float) -> float:
    """Return a AND b.

    min: min(a, b). Product: a b. Bounded difference: max(0, a + b - 1). Drastic product: the other one where one is
    1, otherwise 0. Einstein: a b / (2 - (a + b - a b)). Hamacher: a b / (a + b - a b), 0 for a = b = 0. Nilpotent
    minimum: min(a, b) where a + b > 1, otherwise 0.
    """
    if code == MIN:
        return min(a, b)
    if code == PRODUCT:
        return a * b
    low = min(a, b)
    high = max(a, b)
    if code == BOUNDED_DIFFERENCE:
        return max(0.0, low - (1.0 - high))
    if code == DRASTIC_PRODUCT:
        return low if high >= 1.0 else 0.0
    if code == EINSTEIN_PRODUCT:
        return a * b / (1.0 + (1.0 - a) * (1.0 - b))
    if code == HAMACHER_PRODUCT:
        union = high + low * (1.0 - high)
        return low * (high / union) if union > 0.0 else 0.0
    return low if low > 1.0 - high else 0.0


@borrowing_kernel
def s_norm(code: int, a: float, b: float) -> float:
    """Return a OR b.

    max: max(a, b). Algebraic sum: a + b - a b. Bounded sum: min(1, a + b). Drastic sum: the other one where one is 0,
    otherwise 1. Einstein: (a + b) / (1 + a b). Hamacher: (a + b - 2 a b) / (1 - a b), 1 for a = b = 1. Nilpotent
    maximum: max(a, b) where a + b < 1, otherwise 1.
    """
    if code == MAX:
        return max(a, b)
    low = min(a, b)
    high = max(a, b)
    if code == ALGEBRAIC_SUM:
        return high + low * (1.0 - high)
    if code == BOUNDED_SUM:
        return min(1.0, a + b)
    if code == DRASTIC_SUM:
        return high if low <= 0.0 else 1.0
    if code == EINSTEIN_SUM:
        return (a + b) / (1.0 + a * b)
    if code == HAMACHER_SUM:
        rest = 1.0 - a * b
        return (high * (1.0 - low) + low * (1.0 - high)) / rest if rest > 0.0 else 1.0
    return high if low < 1.0 - high else 1.0
