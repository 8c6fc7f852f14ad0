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

ROUNDING = 1e-15
"""How far a + b may be from 1 and count as 1, where a norm jumps there: degrees are rounded, and those of a partition
add up to 1."""

MAX = 0
ALGEBRAIC_SUM = 1
BOUNDED_SUM = 2
DRASTIC_SUM = 3
EINSTEIN_SUM = 4
HAMACHER_SUM = 5
NILPOTENT_MAXIMUM = 6

SUM = 7
"""Aggregation by an unbounded sum."""
LEAST = 8
"""Aggregation by the minimum, for implications that are large where a rule says nothing."""

IMPLY_BOUNDED_SUM = 7
IMPLY_ALGEBRAIC_SUM = 8
IMPLY_KLEENE_DIENES = 9
"""Implications beside the t-norms, whose codes they share."""


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
    return low if low - ROUNDING > 1.0 - high or high >= 1.0 else 0.0


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
        rest = (1.0 - high) + high * (1.0 - low)  # 1 - a b
        return (high * (1.0 - low) + low * (1.0 - high)) / rest if rest > 0.0 else 1.0
    return high if low + ROUNDING < 1.0 - high or low <= 0.0 else 1.0


@borrowing_kernel
def implication(code: int, w: float, a: float) -> float:
    """Return the degree that a rule of firing strength ``w`` gives to a place of degree ``a`` in its consequent.

    A t-norm, the bounded sum min(1, w + a), the algebraic sum w + a - w a, or Kleene-Dienes: max(1 - w, a).
    """
    if code < IMPLY_BOUNDED_SUM:
        return t_norm(code, w, a)
    if code == IMPLY_BOUNDED_SUM:
        return min(1.0, w + a)
    if code == IMPLY_ALGEBRAIC_SUM:
        return s_norm(ALGEBRAIC_SUM, w, a)
    return max(1.0 - w, a)


@borrowing_kernel
def imply(code, w, degree):
    """Put the implied degrees in the place of a set's degrees (n,)."""
    for i in range(degree.size):
        degree[i] = implication(code, w, degree[i])


@borrowing_kernel
def aggregation(code: int, a: float, b: float) -> float:
    """Return the aggregate of two degrees: by an s-norm, their sum or their minimum."""
    if code == SUM:
        return a + b
    return min(a, b) if code == LEAST else s_norm(code, a, b)


@borrowing_kernel
def bend_level(code: int, w: float) -> float:
    """Return the degree at which an implication bends a set, besides w for the nilpotent minimum; -1 for none."""
    if code == MIN:
        return w
    if code in (BOUNDED_DIFFERENCE, NILPOTENT_MINIMUM, IMPLY_BOUNDED_SUM, IMPLY_KLEENE_DIENES):
        return 1.0 - w
    return -1.0
