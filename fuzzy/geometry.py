"""Piecewise-linear sets as the kernels read them: lines in cells, sides in intervals, polynomials of clip heights.

All of it is plain Python over a handful of corners, computed when a variable is compiled and kept while it stays the
same.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from fuzzy.sets import Segment

Polynomial = tuple[float, float, float, float, float, float, float, float]


class Line(NamedTuple):
    """offset + (x - origin) / run; at the origin a set is lowest, so that small degrees keep all their digits."""

    origin: float
    run: float
    offset: float

    def at(self, x: float) -> float:
        """Return the degree at ``x``."""
        return self.offset + (x - self.origin) / self.run


def line(segment: Segment) -> Line:
    """Return the line on which a segment of some length lies."""
    left, right, at_left, at_right = segment
    if at_left == at_right:
        return Line(0.0, math.inf, at_left)
    if at_left < at_right:
        return Line(left, (right - left) / (at_right - at_left), at_left)
    return Line(right, (left - right) / (at_left - at_right), at_right)


def degree(segment: Segment, x: float) -> float:
    """Return the degree at a point of a segment, exactly so at its ends."""
    if x == segment.left:
        return segment.at_left
    return segment.at_right if x == segment.right else line(segment).at(x)


def knots(sets: Iterable[Sequence[Segment]], low: float, high: float) -> list[float]:
    """Return both ends of a range and the points between them at which a set bends or jumps, ascending."""
    points = {end for segments in sets for segment in segments for end in segment[:2]}
    return sorted({low, high, *(point for point in points if low < point < high)})


def sides(segments: Sequence[Segment], points: Sequence[float]) -> list[tuple[int, Segment]]:
    """Return the intervals between knots in which a set is not 0, and the set's segment there."""
    return [
        (interval, segment)
        for interval, (left, right) in enumerate(itertools.pairwise(points))
        for segment in segments
        if segment.left <= left and right <= segment.right and max(segment.at_left, segment.at_right) > 0.0
    ]


def cells(segments: Sequence[Segment], points: Sequence[float], *, is_open: bool = False) -> list[tuple[int, Line]]:
    """Return the cells in which a set is not 0, and the set's line there; see ``InputTables`` for cells.

    Args:
        segments: The set.
        points: The knots.
        is_open: Whether the set has the smaller degree at a jump, as a closed set's complement has; a closed set has
            the larger one.
    """
    found = [(2 * interval + 2, line(segment)) for interval, segment in sides(segments, points)]
    chosen = min if is_open else max
    for knot, x in enumerate(points):
        here = (degree(segment, x) for segment in segments if segment.left <= x <= segment.right)
        at_knot = chosen(here, default=0.0)
        if at_knot > 0.0:
            found.append((2 * knot + 1, Line(0.0, math.inf, at_knot)))
    return found


def intersection(first: Sequence[Segment], second: Sequence[Segment], low: float, high: float) -> list[Segment]:
    """Return min(first, second) on [low, high], which bends also where the two cross."""
    points = knots((first, second), low, high)
    others = dict(sides(second, points))
    found = []
    for interval, one in sides(first, points):
        if interval not in others:
            continue
        ends = points[interval], points[interval + 1]
        (a, b), (c, d) = ([degree(segment, end) for end in ends] for segment in (one, others[interval]))
        shares = [0.0, (a - c) / ((a - c) - (b - d)), 1.0] if (a - c) * (b - d) < 0.0 else [0.0, 1.0]
        places = [ends[0] + share * (ends[1] - ends[0]) for share in shares[:-1]] + [ends[1]]
        heights = [min(a + share * (b - a), c + share * (d - c)) for share in shares]
        found += [
            Segment(places[i], places[i + 1], heights[i], heights[i + 1])
            for i in range(len(places) - 1)
            if places[i] < places[i + 1]
        ]
    return found


def clipped_to(segments: Sequence[Segment], low: float, high: float) -> list[Segment]:
    """Return the part of a set within [low, high]."""
    found = []
    for segment in segments:
        left, right = max(segment.left, low), min(segment.right, high)
        if left < right:
            found.append(Segment(left, right, degree(segment, left), degree(segment, right)))
    return found


def cut_polynomials(segments: Sequence[Segment], origin: float) -> list[Polynomial]:
    """Return the polynomials of area and moment of a set clipped at a height; see ``fuzzy.kernels.exact``.

    Args:
        segments: The set, within the range of its variable.
        origin: Point about which moments are taken.

    Returns:
        One row for each level t from which on the polynomials differ: t, A, A', A''/2, M, M', M''/2, M'''/6 at that
        level. The first level is 0; the last row, at the set's height, is constant: nothing above it is clipped.
    """
    levels = sorted({0.0, *(end for segment in segments for end in segment[2:])})
    rows: list[Polynomial] = []
    area = moment = 0.0
    for level, above in itertools.pairwise(levels):
        w, m = _level_set(segments, origin, level)
        rows.append((level, area, w[0], w[1] / 2, moment, m[0], m[1] / 2, m[2] / 3))
        step = above - level
        area += step * (w[0] + step * w[1] / 2)
        moment += step * (m[0] + step * (m[1] / 2 + step * m[2] / 3))
    rows.append((levels[-1], area, 0.0, 0.0, moment, 0.0, 0.0, 0.0))
    return rows


def _level_set(
    segments: Sequence[Segment], origin: float, level: float
) -> tuple[tuple[float, float], tuple[float, float, float]]:
    """Return width w0 + w1 d and moment m0 + m1 d + m2 d² of the level set at ``level`` + d."""
    w0 = w1 = m0 = m1 = m2 = 0.0
    for segment in segments:
        left, right = segment.left - origin, segment.right - origin
        bottom, top = sorted(segment[2:])
        if top <= level:
            continue
        if bottom > level or bottom == top:  # this segment lies wholly above the level
            w0 += right - left
            m0 += 0.5 * (left + right) * (right - left)
            continue
        # Only the part next to the higher end is above the level: its far end moves by slope · d.
        slope = (right - left) / (top - bottom)
        reach = slope * (top - level)
        rises = segment.at_right > segment.at_left
        sign = -1.0 if rises else 1.0
        far = right - reach if rises else left + reach
        w0 += reach
        w1 -= slope
        m0 += reach * (0.5 * (far + (right if rises else left)))
        m1 -= slope * far
        m2 += sign * 0.5 * slope * slope
    return (w0, w1), (m0, m1, m2)
