"""Triangular norms and conorms, chosen by code."""

from fuzzy.kernels.jit import borrowing_kernel

MIN = 0
PRODUCT = 1
MAX = 0
ALGEBRAIC_SUM = 1
SUM = 1


@borrowing_kernel
def t_norm(code: int, a: float, b: float) -> float:
    """Return a AND b: min(a, b) or a·b, for degrees in [0, 1]."""
    if code == MIN:
        return min(a, b)
    return a * b


@borrowing_kernel
def s_norm(code: int, a: float, b: float) -> float:
    """Return a OR b: max(a, b) or a + b - a·b, for degrees in [0, 1]."""
    if code == MAX:
        return max(a, b)
    return a + b - a * b
