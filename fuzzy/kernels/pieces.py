"""What is asked of an aggregated set, piece by piece from left to right: area and moment, its bisector, its maxima.

A piece is a straight part of the set. Its answers are summed up in an account, ten numbers, so that the closed forms
and the search along curves share them.
"""

import math

from fuzzy.kernels import codes
from fuzzy.kernels.jit import borrowing_kernel

AREA = 0
"""What to ask: area and moment."""
HALF = 1
"""What to ask: where the area is half of ``TARGET`` · 2."""
TOP = 2
"""What to ask: where the set is largest."""

ACCOUNT = 10
"""Numbers of an account."""

SUM, MOMENT = 0, 1
"""Area and moment so far, under ``AREA``; area so far, under ``HALF``."""
TARGET, STATE, PLACE = 2, 3, 4
"""Under ``HALF``: half the area; 0 searching, 1 found, 2 found at the end of a piece; where."""
BEST, FIRST, LAST, LENGTH, NEAR, FAR = 0, 1, 2, 3, 4, 5
"""Under ``TOP``: the largest degree; where first and last; total length of plateaus; least and greatest magnitude."""
COUNT, PLACES = 6, 7
"""Under ``TOP``: number of single places; sum of plateaus' moments, or of the single places."""

_SAME = 1e-12
"""Difference of two degrees that count as the same, as a share of the greater one."""
_ENDS = 1e-14
"""Difference of the area at the end of a piece from one half that counts as none, as a share of the area."""


@borrowing_kernel
def begin(account, question):
    """Clear an account, but for ``TARGET``, which ``HALF`` needs."""
    target = account[TARGET]
    for i in range(ACCOUNT):
        account[i] = 0.0
    if question == HALF:
        account[TARGET] = target


@borrowing_kernel
def add(account, question, origin, x0, x1, y0, y1):
    """Enter a piece.

    Args:
        account: (10,) what was found so far.
        question: ``AREA``, ``HALF`` or ``TOP``.
        origin: Point about which moments are taken.
        x0: Where the piece begins, not before the last one ended.
        x1: Where it ends.
        y0: Degree just behind ``x0``.
        y1: Degree just before ``x1``.
    """
    length = x1 - x0
    if question == TOP:
        _add_top(account, x0, x1, y0, y1)
        return
    area = 0.5 * length * (y0 + y1)
    if question == AREA:
        account[SUM] += area
        account[MOMENT] += area * (0.5 * (x0 + x1) - origin) + length * length * (y1 - y0) / 12.0
        return
    before = account[SUM]
    account[SUM] = before + area
    if account[STATE] == 2.0 and area > 0.0:
        # Nothing lies between the two halves: the middle of the gap belongs to neither.
        account[PLACE] = 0.5 * (account[PLACE] + x0)
        account[STATE] = 1.0
    elif account[STATE] == 0.0 and account[SUM] >= account[TARGET] * (1.0 - _ENDS):
        rest = min(max(account[TARGET] - before, 0.0), area)
        slope = (y1 - y0) / length if length > 0.0 else 0.0
        root = y0 + math.sqrt(max(y0 * y0 + 2.0 * slope * rest, 0.0))
        account[PLACE] = min(x0 + (2.0 * rest / root if root > 0.0 else 0.0), x1)
        account[STATE] = 1.0
        if account[SUM] <= account[TARGET] * (1.0 + _ENDS):
            account[PLACE] = x1
            account[STATE] = 2.0


@borrowing_kernel
def _add_top(account, x0, x1, y0, y1):
    highest = max(y0, y1)
    if highest <= 0.0 or highest < account[BEST] * (1.0 - _SAME):
        return
    if highest > account[BEST] * (1.0 + _SAME):
        begin(account, TOP)
        account[BEST] = highest
        account[FIRST] = math.inf
        account[NEAR] = math.inf
    start = x0 if y0 >= highest * (1.0 - _SAME) else x1
    end = x1 if y1 >= highest * (1.0 - _SAME) else x0
    if start < end:
        if account[LENGTH] == 0.0:  # places beside a plateau count for nothing
            account[PLACES] = 0.0
        account[LENGTH] += end - start
        account[PLACES] += (end - start) * 0.5 * (start + end)
    elif account[LENGTH] == 0.0 and (account[COUNT] == 0.0 or start > account[LAST]):
        account[COUNT] += 1.0
        account[PLACES] += start
    account[FIRST] = min(account[FIRST], start)
    account[LAST] = end
    near = 0.0 if start < 0.0 < end else start if abs(start) <= abs(end) else end
    if abs(near) < abs(account[NEAR]):
        account[NEAR] = near
    far = start if abs(start) >= abs(end) else end
    if abs(far) > abs(account[FAR]):
        account[FAR] = far


@borrowing_kernel
def centre(account, origin):
    """Return the centroid, after ``AREA`` with moments about ``origin``; NaN where there is no area."""
    return origin + account[MOMENT] / account[SUM] if account[SUM] > 0.0 else math.nan


@borrowing_kernel
def aim(account):
    """Let ``HALF`` look for half of the area that ``AREA`` has found; return whether there is any."""
    account[TARGET] = 0.5 * account[SUM]
    return account[SUM] > 0.0


@borrowing_kernel
def top(account, which):
    """Return one of the places at which the set is largest; NaN where it is 0 everywhere."""
    if account[BEST] <= 0.0:
        return math.nan
    if which == codes.SMALLEST:
        return account[FIRST]
    if which == codes.LARGEST:
        return account[LAST]
    if which == codes.SMALLEST_MAGNITUDE:
        return account[NEAR]
    if which == codes.LARGEST_MAGNITUDE:
        return account[FAR]
    return account[PLACES] / (account[LENGTH] if account[LENGTH] > 0.0 else account[COUNT])
