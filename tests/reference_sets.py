"""Defuzzification, slow and obvious: the second half of ``reference``.

Piecewise-linear sets under operators that keep lines straight become straight pieces in fractions. All other sets are
integrated by Gauss and Legendre between the places, found by bisection, where they could bend.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence

import mpmath
import numpy as np

from fuzzy.shapes import (
    Bell,
    Cosine,
    Gaussian,
    Gaussian2,
    Linear,
    PiShape,
    Shape,
    Sigmoid,
    SigmoidDifference,
    SigmoidProduct,
    Singleton,
    Spike,
    SShape,
    ZShape,
    locations,
)
from fuzzy.system import FuzzySystem, Output, Sampling, Term
from tests import reference
from tests.reference import Conclusion, Number

STRAIGHT_IMPLICATIONS = frozenset(reference.IMPLICATIONS) - {"einstein_product", "hamacher_product"}
STRAIGHT_AGGREGATIONS = frozenset({"max", "sum", "bounded_sum", "min"})
MAXIMA = ("mom", "som", "lom", "som_abs", "lom_abs")
WEIGHTED = ("height", "weighted_average", "weighted_sum")

Piece = tuple[Number, Number, Number, Number]
"""Where a straight piece begins and ends, and its degrees just inside both ends."""


def infer(system: FuzzySystem, *inputs: float, strengths: Sequence[float] | None = None) -> list[Number | None]:
    """Return the crisp outputs; None where they are undefined.

    Args:
        system: A valid system.
        *inputs: Crisp inputs.
        strengths: Firing strengths to begin with, in place of those that follow from the inputs.
    """
    number = reference.number_of(system)
    rules = reference.all_rules(system)
    if strengths is None:
        found = reference.firing_strengths(system, *inputs)
    else:
        found = [number(strength) for strength in strengths]
    clamped = [
        min(max(number(x), number(variable.low)), number(variable.high))
        for variable, x in zip(system.inputs, inputs, strict=True)
    ]
    return [
        _defuzzify(system, output, reference.conclusions_of(rules, found, output), clamped) for output in system.outputs
    ]


def is_straight(system: FuzzySystem, conclusions: list[Conclusion]) -> bool:
    """Return whether the aggregate of these conclusions consists of straight pieces."""
    return (
        all(isinstance(term.shape, reference.STRAIGHT) for _, term in conclusions)
        and system.inference.implication in STRAIGHT_IMPLICATIONS
        and reference.aggregation(system) in STRAIGHT_AGGREGATIONS
    )


def _defuzzify(
    system: FuzzySystem, output: Output, conclusions: list[Conclusion], inputs: list[Number]
) -> Number | None:
    if not conclusions:
        return None
    defuzzifier = system.inference.defuzzifier
    all_points = all(isinstance(term.shape, Singleton) and not term.complement for term in output.terms)
    if defuzzifier in WEIGHTED or all_points:
        return _weighted(system, output, conclusions, inputs)
    if isinstance(system.inference.resolution, Sampling):
        return sampled_with_numpy(system, output, conclusions)
    if is_straight(system, conclusions):
        return _of_pieces(defuzzifier, straight_pieces(system, output, conclusions))
    return _of_curve(system, output, conclusions)


def _weighted(
    system: FuzzySystem, output: Output, conclusions: list[Conclusion], inputs: list[Number]
) -> Number | None:
    if reference.aggregation(system) == "max":
        best: dict[str, Conclusion] = {}
        for strength, term in conclusions:
            if term.name not in best or strength > best[term.name][0]:
                best[term.name] = (strength, term)
        conclusions = list(best.values())
    moment = sum(w * _value(system, output, term, w, inputs) for w, term in conclusions)
    weight = sum(w for w, _ in conclusions)
    return moment if system.inference.defuzzifier == "weighted_sum" else moment / weight


def _value(system: FuzzySystem, output: Output, term: Term, w: Number, inputs: list[Number]) -> Number:
    number = reference.number_of(system)
    if isinstance(term.shape, Linear):
        products = (number(c) * x for c, x in zip(term.shape.coefficients, inputs, strict=True))
        return sum(products, number(term.shape.constant))
    if isinstance(term.shape, Singleton):
        return number(term.shape.value)
    low, high = number(output.low), number(output.high)
    rises = reference.term_degree(term, high, number) > reference.term_degree(term, low, number)
    for _ in range(80):  # Tsukamoto
        middle = (low + high) / 2
        if (reference.term_degree(term, middle, number) >= w) == rises:
            high = middle
        else:
            low = middle
    return (low + high) / 2


def straight_pieces(system: FuzzySystem, output: Output, conclusions: list[Conclusion]) -> list[Piece]:
    """Return the straight pieces of the aggregated set; exact.

    Between two vertices every set is a line, known from two inner points: at the vertices themselves it may jump. An
    implication bends it at the levels w and 1 - w; between these places too the aggregate may bend where implied
    lines cross each other, or their sum crosses 1.
    """
    number = reference.exact
    conclusions = [(number(float(strength)), term) for strength, term in conclusions]
    implication = reference.IMPLICATIONS[system.inference.implication]
    joined = reference.aggregation(system)
    ends = {number(output.low), number(output.high)}
    ends |= {number(x) for _, term in conclusions for x in locations(term.shape) if output.low < x < output.high}
    levels = {level for strength, _ in conclusions for level in _levels(system.inference.implication, strength)}
    found = []
    for left, right in itertools.pairwise(sorted(ends)):
        inner = [left + (right - left) / 4, right - (right - left) / 4]
        lines = [[reference.term_degree(term, u, number) for u in inner] for _, term in conclusions]
        lines += [[level, level] for level in levels]
        for start, end in itertools.pairwise(_divided(left, right, inner, lines)):
            within = [start + (end - start) / 4, end - (end - start) / 4]
            implied = [
                [implication(strength, reference.term_degree(term, u, number)) for u in within]
                for strength, term in conclusions
            ]
            if joined == "bounded_sum":
                implied = [[sum(line[i] for line in implied) for i in (0, 1)], [number(1), number(1)]]
            inside = [start, end] if joined == "sum" else _divided(start, end, within, implied)
            for first, last in itertools.pairwise(inside):
                u1, u2 = first + (last - first) / 4, last - (last - first) / 4
                y1, y2 = (reference.aggregated(system, conclusions, u, number) for u in (u1, u2))
                slope = (y2 - y1) / (u2 - u1)
                found.append((first, last, y1 + slope * (first - u1), y2 + slope * (last - u2)))
    return found


def _levels(implication: str, strength: Number) -> tuple[Number, ...]:
    """Return the degrees at which an implication bends a set, or nearly so."""
    match implication:
        case "min" | "hamacher_product":  # which is steep there, where the strength is small
            return (strength,)
        case "nilpotent_minimum":
            return (strength, 1 - strength)
        case "bounded_difference" | "bounded_sum" | "kleene_dienes":
            return (1 - strength,)
        case _:
            return ()


def _divided(left: Number, right: Number, inner: list[Number], lines: list[list[Number]]) -> list[Number]:
    """Return the ends of an interval and the places between at which two of the lines cross."""
    places = {left, right}
    for (a1, a2), (b1, b2) in itertools.combinations({tuple(line) for line in lines}, 2):
        if a2 - a1 != b2 - b1:
            place = inner[0] + (b1 - a1) / ((a2 - a1) - (b2 - b1)) * (inner[1] - inner[0])
            if left < place < right:
                places.add(place)
    return sorted(places)


def _of_pieces(defuzzifier: str, pieces: list[Piece]) -> Number | None:
    areas = [(x1 - x0) * (y0 + y1) / 2 for x0, x1, y0, y1 in pieces]
    total = sum(areas)
    if defuzzifier in MAXIMA:
        return _maximum(defuzzifier, pieces)
    if total <= 0:
        return None
    if defuzzifier == "bisector":
        return _bisector(pieces, areas)
    moments = [
        area * (x0 + x1) / 2 + (y1 - y0) * (x1 - x0) ** 2 / 12
        for area, (x0, x1, y0, y1) in zip(areas, pieces, strict=True)
    ]
    return sum(moments) / total


def _bisector(pieces: list[Piece], areas: list[Number]) -> Number:
    half, before = sum(areas) / 2, areas[0] * 0
    for i, (x0, x1, y0, y1) in enumerate(pieces):
        if before + areas[i] > half:
            rest, slope = half - before, (y1 - y0) / (x1 - x0)
            if slope == 0 or rest == 0:
                return x0 + (rest / y0 if rest else 0)
            root = mpmath.sqrt(mpmath.mpf(float(y0)) ** 2 + 2 * mpmath.mpf(float(slope * rest)))
            return float(x0) + 2 * float(rest) / (float(y0) + float(root))
        if before + areas[i] == half:
            behind = next(piece[0] for piece, area in zip(pieces[i + 1 :], areas[i + 1 :], strict=True) if area > 0)
            return (x1 + behind) / 2
        before += areas[i]
    raise AssertionError(areas)


def _maximum(which: str, pieces: list[Piece]) -> Number | None:
    highest = max(max(y0, y1) for _, _, y0, y1 in pieces)
    if highest <= 0:
        return None
    level = [(x0, x1) for x0, x1, y0, y1 in pieces if y0 == y1 == highest]
    single = {x for x0, x1, y0, y1 in pieces for x, y in ((x0, y0), (x1, y1)) if y == highest}
    match which:
        case "mom":
            if level:
                return sum((x1 - x0) * (x0 + x1) / 2 for x0, x1 in level) / sum(x1 - x0 for x0, x1 in level)
            return sum(single) / len(single)
        case "som":
            return min(single)
        case "lom":
            return max(single)
        case "som_abs":
            return 0 if any(x0 < 0 < x1 for x0, x1 in level) else min(sorted(single), key=abs)
        case _:
            return max(sorted(single), key=abs)


def _of_curve(system: FuzzySystem, output: Output, conclusions: list[Conclusion]) -> float | None:
    """Return centroid, center of sums or bisector in double precision."""
    nodes, weights = np.polynomial.legendre.leggauss(40)
    middle = 0.5 * (output.low + output.high)
    places = bends(system, output, conclusions)

    def integral(start: float, end: float) -> tuple[float, float]:
        u = 0.5 * (start + end) + 0.5 * (end - start) * nodes
        degrees = 0.5 * (end - start) * weights * numpy_aggregated(system, conclusions, u)
        return math.fsum(degrees), math.fsum(degrees * (u - middle))

    parts = [integral(start, end) for start, end in itertools.pairwise(places)]
    total = math.fsum(area for area, _ in parts)
    if total <= 0.0:
        return None
    if system.inference.defuzzifier != "bisector":
        return math.fsum(moment for _, moment in parts) / total + middle
    before = 0.0
    for (area, _), (start, end) in zip(parts, itertools.pairwise(places), strict=True):
        if before + area >= total / 2:
            low, high = start, end
            for _ in range(60):
                x = (low + high) / 2
                low, high = (low, x) if before + integral(start, x)[0] > total / 2 else (x, high)
            return (low + high) / 2
        before += area
    raise AssertionError(parts)


def bends(system: FuzzySystem, output: Output, conclusions: list[Conclusion]) -> list[float]:
    """Return the points between which the aggregated set is analytic and no peak is hidden from a quadrature."""
    points = {output.low, output.high}
    for _, term in conclusions:
        points |= set(landmarks(term.shape))
    found = sorted(u for u in points if output.low <= u <= output.high)
    levels = [_levels(system.inference.implication, float(strength)) for strength, _ in conclusions]
    joined = reference.aggregation(system)

    def indicators(u: np.ndarray) -> np.ndarray:
        degrees = np.array([numpy_degrees(term, u) for _, term in conclusions])
        rows = [degrees[[k]] - level for k, both in enumerate(levels) for level in both]
        implied = _implied(system, conclusions, u)
        if joined in {"max", "min", "nilpotent_maximum"}:
            rows += [implied[[i]] - implied[[j]] for i, j in itertools.combinations(range(len(implied)), 2)]
        if joined in {"bounded_sum", "nilpotent_maximum"}:
            total = implied[0]
            for row in implied[1:]:
                rows.append((total + row - 1)[np.newaxis])
                total = _NUMPY_AGGREGATIONS[joined](total, row)
        return np.vstack(rows) if rows else np.ones((1, u.size))

    return sorted({*found, *_sign_changes(indicators, found)})


def landmarks(shape: Shape) -> list[float]:
    """Return places of a shape between which a polynomial follows it."""
    counts = (0, 0.5, 1, 2, 4, 8, 16, 38)
    match shape:
        case Gaussian(mean=center, sigma=unit) | Bell(center=center, width=unit):
            units = [(center, unit)]
        case Spike(center=center, width=width):
            units = [(center, width / 5)]
        case Cosine(center=center, width=width):
            units = [(center, width / 2)]
        case Gaussian2():
            units = [(shape.left_mean, shape.left_sigma), (shape.right_mean, shape.right_sigma)]
        case Sigmoid(center=center, slope=slope):
            units = [(center, 1 / slope)]
        case SigmoidDifference() | SigmoidProduct():
            units = [(shape.left_center, 1 / shape.left_slope), (shape.right_center, 1 / shape.right_slope)]
        case SShape(a=a, b=b) | ZShape(a=a, b=b):
            return [a, (a + b) / 2, b]
        case PiShape(a=a, b=b, c=c, d=d):
            return [a, (a + b) / 2, b, c, (c + d) / 2, d]
        case _:
            return [place for place in locations(shape) if math.isfinite(place)]
    return [
        center + side * count * unit for center, unit in units for side in (-1, 1) for count in counts
        if math.isfinite(center)
    ]  # fmt: skip


def _sign_changes(indicators: Callable[[np.ndarray], np.ndarray], places: list[float]) -> list[float]:
    """Return where any of several functions changes its sign, found on a grid and then by bisection, of all at once."""
    ends = np.array(places)
    inset = 1e-12 * np.diff(ends)  # at the places themselves a set may jump
    grid = np.linspace(ends[:-1] + inset, ends[1:] - inset, 201, axis=1)
    is_positive = indicators(grid.ravel()) > 0
    is_positive = is_positive.reshape(-1, *grid.shape)
    row, interval, i = np.nonzero(is_positive[:, :, 1:] != is_positive[:, :, :-1])
    start, end, at_start = grid[interval, i], grid[interval, i + 1], is_positive[row, interval, i]
    for _ in range(60 if row.size else 0):
        middle = 0.5 * (start + end)
        is_like_start = (indicators(middle)[row, np.arange(row.size)] > 0) == at_start
        start, end = np.where(is_like_start, middle, start), np.where(is_like_start, end, middle)
    return end.tolist()


def _implied(system: FuzzySystem, conclusions: list[Conclusion], u: np.ndarray) -> np.ndarray:
    """Return (n_conclusions, n) degrees of the implied sets, times 2**600 where all are tiny and would underflow."""
    rule = system.inference.implication
    is_tiny = all(strength < 1e-200 for strength, _ in conclusions) and rule in {"min", "product"}
    scale = 2.0**600 if is_tiny else 1.0
    rows = []
    for strength, term in conclusions:
        w, a = float(strength), numpy_degrees(term, u)
        if rule == "product":
            rows.append(scale * w * a)
        else:
            rows.append(scale * _NUMPY_IMPLICATIONS[rule](w, a))
    return np.array(rows)


_NUMPY_IMPLICATIONS: dict[str, Callable[[float, np.ndarray], np.ndarray]] = {
    "min": lambda w, a: np.minimum(w, a),
    "product": lambda w, a: w * a,
    "bounded_difference": lambda w, a: np.maximum(0.0, w + a - 1.0),
    "drastic_product": lambda w, a: np.where(a == 1.0, w, a if w == 1.0 else 0.0),
    "einstein_product": lambda w, a: w * a / (2.0 - (w + a - w * a)),
    "hamacher_product": lambda w, a: w * a / (w + a - w * a),
    "nilpotent_minimum": lambda w, a: np.where(w + a > 1.0, np.minimum(w, a), 0.0),
    "bounded_sum": lambda w, a: np.minimum(1.0, w + a),
    "algebraic_sum": lambda w, a: w + a - w * a,
    "kleene_dienes": lambda w, a: np.maximum(1.0 - w, a),
}
_NUMPY_AGGREGATIONS: dict[str, Callable[[np.ndarray, np.ndarray], np.ndarray]] = {
    "max": np.maximum,
    "min": np.minimum,
    "sum": np.add,
    "algebraic_sum": lambda a, b: a + b - a * b,
    "bounded_sum": lambda a, b: np.minimum(1.0, a + b),
    "drastic_sum": lambda a, b: np.where(a == 0.0, b, np.where(b == 0.0, a, 1.0)),
    "einstein_sum": lambda a, b: (a + b) / (1.0 + a * b),
    "hamacher_sum": lambda a, b: np.where(
        a * b < 1.0, (a * (1.0 - b) + b * (1.0 - a)) / np.maximum(1.0 - a * b, 1e-300), 1.0
    ),
    "nilpotent_maximum": lambda a, b: np.where(a + b < 1.0, np.maximum(a, b), 1.0),
}


def numpy_aggregated(system: FuzzySystem, conclusions: list[Conclusion], u: np.ndarray) -> np.ndarray:
    """Return the degrees of the aggregated set at u."""
    implied = _implied(system, conclusions, u)
    total = implied[0]
    for row in implied[1:]:
        total = _NUMPY_AGGREGATIONS[reference.aggregation(system)](total, row)
    return total


def sampled_with_numpy(system: FuzzySystem, output: Output, conclusions: list[Conclusion]) -> float | None:
    """Return the sampled output as a line of numpy would have it."""
    resolution = system.inference.resolution
    assert isinstance(resolution, Sampling)
    if not conclusions:
        return None
    if resolution.rule == "polygon":
        return _of_polygon(system, conclusions, np.linspace(output.low, output.high, resolution.points))
    n, low, high = resolution.points, output.low, output.high
    weight = np.ones(n)
    match resolution.rule:
        case "endpoints" | "trapezoid":
            u = np.linspace(low, high, n)
            if resolution.rule == "trapezoid":
                weight[0] = weight[-1] = 0.5
        case "midpoints":
            u = low + (np.arange(n) + 0.5) * (high - low) / n
        case _:
            u = np.array(list(itertools.accumulate([(high - low) / n] * (n - 1), initial=low)))
            if resolution.rule == "left_with_break_points":
                bent = [x for term in output.terms for x in locations(term.shape) if low <= x <= high]
                u = np.union1d(_added_up_in_single_precision(low, high, n), bent)
                weight = np.ones(u.size)
    degrees = numpy_aggregated(system, conclusions, u)
    if system.inference.defuzzifier in MAXIMA:
        return _top(system.inference.defuzzifier, u, degrees)
    total = weight * degrees
    return float((u * total).sum() / total.sum()) if total.sum() > 0 else None


def _top(which: str, u: np.ndarray, degrees: np.ndarray) -> float | None:
    top = u[degrees >= degrees.max() * (1 - 1e-12)]
    chosen = {"mom": top.mean(), "som": top[0], "lom": top[-1]}
    chosen |= {"som_abs": top[abs(top).argmin()], "lom_abs": top[abs(top).argmax()]}
    return float(chosen[which]) if degrees.max() > 0 else None


def _of_polygon(system: FuzzySystem, conclusions: list[Conclusion], u: np.ndarray) -> float | None:
    """Return what scikit-fuzzy does: cut every set that is known at u, and join the points that it then knows."""
    implication, joined = system.inference.implication, reference.aggregation(system)
    if joined == ("min" if implication == "kleene_dienes" else "max"):
        conclusions = [max(same, key=lambda entry: entry[0]) for same in _by_term(conclusions)]
    known = [(float(strength), numpy_degrees(term, u)) for strength, term in conclusions]
    points = set(u.tolist())
    for w, degrees in known:
        levels = {"min": w, "product": None, "einstein_product": None, "hamacher_product": None}
        level = levels.get(implication, 1.0 - w)
        if level is None or implication in {"drastic_product", "algebraic_sum"}:
            continue
        for i in np.flatnonzero((degrees[:-1] - level) * (degrees[1:] - level) < 0):
            points.add(float(u[i] + (level - degrees[i]) / (degrees[i + 1] - degrees[i]) * (u[i + 1] - u[i])))
    x = np.array(sorted(points))
    is_tiny = all(w < 1e-200 for w, _ in known) and implication in {"min", "product"}
    rows = [
        (2.0**600 if is_tiny else 1.0) * _NUMPY_IMPLICATIONS[implication](w, np.interp(x, u, degrees))
        for w, degrees in known
    ]
    total = rows[0]
    for row in rows[1:]:
        total = _NUMPY_AGGREGATIONS[joined](total, row)
    if system.inference.defuzzifier in MAXIMA:
        return _top(system.inference.defuzzifier, x, total)
    pieces = list(zip(x[:-1].tolist(), x[1:].tolist(), total[:-1].tolist(), total[1:].tolist(), strict=True))
    found = _of_pieces(system.inference.defuzzifier, pieces)
    return None if found is None else float(found)


def _by_term(conclusions: list[Conclusion]) -> list[list[Conclusion]]:
    found: dict[str, list[Conclusion]] = {}
    for entry in conclusions:
        found.setdefault(entry[1].name, []).append(entry)
    return list(found.values())


def _added_up_in_single_precision(low: float, high: float, n: int) -> list[float]:
    """Return left ends of n intervals as JFML's loop finds them."""
    found, u, step = [], np.float32(low), (np.float32(high) - np.float32(low)) / np.float32(n)
    while u < high and len(found) < 2 * n:
        found.append(float(u))
        u = np.float32(u + step)
    return found


def numpy_degrees(term: Term, u: np.ndarray) -> np.ndarray:
    """Return the membership degrees of u in double precision."""
    found = _numpy_shape(term.shape, u)
    return term.height * (1.0 - found if term.complement else found)


def _numpy_shape(shape: Shape, u: np.ndarray) -> np.ndarray:  # noqa: C901
    def sigmoid(center: float, slope: float) -> np.ndarray:
        with np.errstate(over="ignore"):
            return 1.0 / (1.0 + np.exp(-slope * (u - center)))

    def rising(a: float, b: float, x: np.ndarray) -> np.ndarray:
        share = np.clip((x - a) / (b - a), 0, 1) if a < b else 1.0 * (x >= b)
        return np.where(share <= 0.5, 2 * share**2, 1 - 2 * (1 - share) ** 2)

    match shape:
        case Gaussian(mean=mean, sigma=sigma):
            return np.exp(-(((u - mean) / sigma) ** 2) / 2)
        case Gaussian2(left_mean=left, left_sigma=left_sigma, right_mean=right, right_sigma=right_sigma):
            below = np.minimum(u - left, 0) / left_sigma if math.isfinite(left) else 0.0
            above = np.maximum(u - right, 0) / right_sigma if math.isfinite(right) else 0.0
            return np.exp(-(below**2 + above**2) / 2) + 0.0 * u
        case Bell(center=center, width=width, slope=slope):
            return 1.0 / (1.0 + np.abs((u - center) / width) ** (2 * slope))
        case Sigmoid(center=center, slope=slope):
            return sigmoid(center, slope)
        case SigmoidDifference(left_center=a, left_slope=b, right_center=c, right_slope=d):
            return np.abs(sigmoid(a, b) - sigmoid(c, d))
        case SigmoidProduct(left_center=a, left_slope=b, right_center=c, right_slope=d):
            return sigmoid(a, b) * sigmoid(c, d)
        case SShape(a=a, b=b):
            return rising(a, b, u)
        case ZShape(a=a, b=b):
            return rising(-b, -a, -u)
        case PiShape(a=a, b=b, c=c, d=d):
            return rising(a, b, u) * rising(-d, -c, -u)
        case Cosine(center=center, width=width):
            share = (u - center) / width
            return np.where(np.abs(share) <= 0.5, 0.5 * (1 + np.cos(2 * np.pi * share)), 0.0)
        case Spike(center=center, width=width):
            return np.exp(-np.abs(10 / width * (u - center)))
        case _:
            return np.array([float(reference.degree(shape, float(x), float)) for x in u])
