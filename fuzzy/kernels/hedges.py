"""Linguistic hedges: functions of a degree, chosen by code.

References:
    Zadeh, "A Fuzzy-Set-Theoretic Interpretation of Linguistic Hedges", 1972; IEEE 1855-2016 for the names; fuzzylite
    6 for seldom.
"""

import math

from fuzzy.kernels.jit import borrowing_kernel

VERY = 0
EXTREMELY = 1
SOMEWHAT = 2
MORE_OR_LESS = 3
PLUS = 4
INTENSIFY = 5
SELDOM = 6
ANY = 7


@borrowing_kernel
def hedge(code: int, a: float) -> float:
    """Return the hedged degree.

    Very: a². Extremely: a³. Somewhat: √a. More or less: ∛a. Plus: a^1.25. Intensify: 2 a² up to 1/2, from there on
    1 - 2 (1 - a)². Seldom, its inverse: √(a / 2) up to 1/2, from there on 1 - √((1 - a) / 2). Any: 1.
    """
    if code == VERY:
        return a * a
    if code == EXTREMELY:
        return a * a * a
    if code == SOMEWHAT:
        return math.sqrt(a)
    if code == MORE_OR_LESS:
        return a ** (1.0 / 3.0)
    if code == PLUS:
        return a**1.25
    if code == INTENSIFY:
        return 2.0 * a * a if a <= 0.5 else 1.0 - 2.0 * (1.0 - a) * (1.0 - a)
    if code == SELDOM:
        return math.sqrt(0.5 * a) if a <= 0.5 else 1.0 - math.sqrt(0.5 * (1.0 - a))
    return 1.0
