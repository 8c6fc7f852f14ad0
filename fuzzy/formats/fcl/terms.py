"""Terms of an .fcl file: points, a number, jFuzzyLogic's functions, fuzzylite's terms; and how far they reach."""

from __future__ import annotations

import math

from fuzzy.errors import expected, shown
from fuzzy.formats.fcl import words
from fuzzy.formats.fcl.tokens import Cursor
from fuzzy.formats.fll import words as fuzzylite
from fuzzy.formats.source import number
from fuzzy.shapes import (
    MAX_POINTS,
    Bell,
    Cosine,
    Gaussian,
    Gaussian2,
    Points,
    Shape,
    Sigmoid,
    SigmoidDifference,
    Singleton,
    Trapezoid,
    Triangle,
    locations,
)

_FUZZYLITE = {word.upper(): word for word in (*fuzzylite.SHAPES, "Discrete", "Linear", *fuzzylite.REFUSED)}
_MOST_PARAMETERS = 2 * MAX_POINTS + 2


def read_term(cursor: Cursor, n_inputs: int) -> tuple[Shape, float, str]:
    """Read what stands behind ``:=``.

    Returns:
        The shape, its height, and the dialect whose words it uses: "fuzzylite", "jFuzzyLogic", or "" for the standard.

    Raises:
        FormatError: At the first word that is wrong, or for what the document cannot say.
    """
    if cursor.text == "(":
        return shape_of_points(read_points(cursor)), 1.0, ""
    if number(cursor.text) is not None:
        return Singleton(cursor.number()), 1.0, ""
    word, offset = cursor.word, cursor.offset
    if word == "SINGLETONS":
        cursor.take()
        points = read_points(cursor)
        if len(points) > 1 or points[0][1] != 1:
            raise cursor.source.error("SINGLETONS other than one of degree 1 cannot be said in the workbench", offset)
        return Singleton(points[0][0]), 1.0, "jFuzzyLogic"
    if word == "FUNCTION":
        raise cursor.source.error("FUNCTION cannot be said in the workbench", offset)
    if word in words.SHAPES:
        cursor.take()
        kind = words.SHAPES[word]
        return kind.build(*(cursor.number() for _ in range(kind.n_parameters))), 1.0, "jFuzzyLogic"
    if word in _FUZZYLITE:
        cursor.take()
        values: list[float] = []
        while number(cursor.text) is not None and len(values) < _MOST_PARAMETERS:
            values.append(cursor.number())
        shape, height = fuzzylite.shape(cursor.source, _FUZZYLITE[word], values, offset, n_inputs)
        return shape, height, "fuzzylite"
    if word and (word[0].isalpha() or word[0] == "_"):
        valid = ("(x, degree) …", *words.SHAPES, *fuzzylite.SHAPES)
        message = f"unknown membership function {expected(shown(cursor.text), valid)}"
        raise cursor.source.error(f"{message}; variables cannot be said in the workbench", offset)
    raise cursor.unexpected("a membership function")


def read_points(cursor: Cursor) -> list[tuple[float, float]]:
    """Read ``(x, degree) (x, degree) …``."""
    points: list[tuple[float, float]] = []
    while cursor.accept("("):
        x = cursor.number()
        cursor.require(",")
        points.append((x, cursor.number()))
        cursor.require(")")
        if len(points) > MAX_POINTS:
            raise cursor.source.error(f"more than {MAX_POINTS} points", cursor.offset)
    if not points:
        raise cursor.unexpected("'('")
    return points


def shape_of_points(points: list[tuple[float, float]]) -> Shape:
    """Return a triangle or trapezoid where points say just that, otherwise the points."""
    x = [place for place, _ in points]
    degrees = [degree for _, degree in points]
    if x == sorted(x) and all(map(math.isfinite, x)):
        match degrees:
            case [0.0, 1.0, 0.0]:
                return Triangle(x[0], x[1], x[2])
            case [0.0, 1.0, 1.0, 0.0]:
                return Trapezoid(x[0], x[1], x[2], x[3])
            case [1.0, 0.0]:
                return Triangle(-math.inf, x[0], x[1])
            case [0.0, 1.0]:
                return Triangle(x[0], x[1], math.inf)
            case [1.0, 1.0, 0.0]:
                return Trapezoid(-math.inf, x[0], x[1], x[2])
            case [0.0, 1.0, 1.0]:
                return Trapezoid(x[0], x[1], x[2], math.inf)
    return Points(tuple(points))


def span(shape: Shape) -> tuple[float, float]:
    """Return how far jFuzzyLogic takes a set to reach where the file gives no range."""
    match shape:
        case Gaussian(mean=mean, sigma=sigma):
            return mean - 4 * sigma, mean + 4 * sigma
        case Gaussian2(left_mean=left, left_sigma=left_sigma, right_mean=right, right_sigma=right_sigma):
            return left - 4 * left_sigma, right + 4 * right_sigma
        case Bell(center=center, width=width, slope=slope):
            reach = 999 ** (1 / (2 * slope)) * width if slope > 0.01 else math.inf
            return center - reach, center + reach
        case Cosine(center=center, width=width):
            return center - width / 2, center + width / 2
        case Sigmoid(center=center, slope=slope):
            return _sigmoid(center, slope)
        case SigmoidDifference():
            both = (_sigmoid(shape.left_center, shape.left_slope), _sigmoid(shape.right_center, shape.right_slope))
            return min(end[0] for end in both), max(end[1] for end in both)
        case _:
            ends = [value for value in locations(shape) if math.isfinite(value)]
            return (min(ends), max(ends)) if ends else (math.inf, -math.inf)


def _sigmoid(center: float, slope: float) -> tuple[float, float]:
    reach = 9 / abs(slope) if slope else math.inf
    return center - reach, center + reach
