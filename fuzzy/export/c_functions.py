"""C functions for shapes, norms and hedges; only those that a system uses are written.

Every formula is the kernel's, so that both give the same numbers. ``REAL`` is double or float, ``M(name)`` the function
of the C library for it, ``C(x)`` a constant.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

from fuzzy import sets
from fuzzy.kernels import codes
from fuzzy.shapes import Points
from fuzzy.system import Term

_TRAPEZOID = """
static REAL trapezoid(REAL x, REAL a, REAL b, REAL c, REAL d)
{
    if (x < b)
        return x <= a ? C(0.0) : (x - a) / (b - a);
    if (x > c)
        return x >= d ? C(0.0) : (x - d) / (c - d);
    return C(1.0);
}
"""
_GAUSSIAN = """
static REAL gaussian(REAL x, REAL mean, REAL sigma)
{
    REAL z = (x - mean) / sigma;
    return M(exp)(C(-0.5) * z * z);
}
"""
_GAUSSIAN2 = """
static REAL gaussian2(REAL x, REAL m1, REAL s1, REAL m2, REAL s2)
{
    REAL left = x < m1 ? (x - m1) / s1 : C(0.0);
    REAL right = x > m2 ? (x - m2) / s2 : C(0.0);
    return M(exp)(C(-0.5) * (left * left + right * right));
}
"""
_BELL = """
static REAL bell(REAL x, REAL center, REAL width, REAL slope)
{
    return C(1.0) / (C(1.0) + M(pow)(M(fabs)((x - center) / width), C(2.0) * slope));
}
"""
_SIGMOID = """
static REAL sigmoid(REAL x, REAL center, REAL slope)
{
    return C(1.0) / (C(1.0) + M(exp)(-slope * (x - center)));
}
"""
_S_SHAPE = """
static REAL s_shape(REAL above, REAL below, REAL width)
{
    REAL part;
    if (below <= C(0.0))
        return C(1.0);
    if (above <= C(0.0))
        return C(0.0);
    part = (above <= below ? above : below) / width;
    return above <= below ? C(2.0) * part * part : C(1.0) - C(2.0) * part * part;
}
"""
_COSINE = """
static REAL cosine(REAL x, REAL center, REAL width)
{
    REAL z = (x - center) / width;
    return M(fabs)(z) <= C(0.5) ? C(0.5) * (C(1.0) + M(cos)(C(6.283185307179586) * z)) : C(0.0);
}
"""
_SPIKE = """
static REAL spike(REAL x, REAL center, REAL width)
{
    return M(exp)(-M(fabs)(C(10.0) / width * (x - center)));
}
"""
_CONCAVE = """
static REAL concave(REAL x, REAL inflection, REAL end)
{
    if ((inflection < end) == (x < end))
        return (end - inflection) / (C(2.0) * end - inflection - x);
    return C(1.0);
}
"""
_POINTS = """
static REAL points(REAL x, const REAL *place, const REAL *degree, int count)
{
    REAL found;
    int i = 0;
    if (x < place[0])
        return degree[0];
    if (x > place[count - 1])
        return degree[count - 1];
    while (i + 1 < count && place[i + 1] < x)
        i++;
    if (place[i] < x && i + 1 < count && place[i + 1] > x)
        return degree[i] + (x - place[i]) * (degree[i + 1] - degree[i]) / (place[i + 1] - place[i]);
    found = C(0.0); /* x is one of the places: the larger degree counts at a jump */
    for (; i < count && place[i] <= x; i++)
        if (place[i] >= x && degree[i] > found)
            found = degree[i];
    return found;
}
"""

T_NORMS = {
    "min": "return a < b ? a : b;",
    "product": "return a * b;",
    "bounded_difference": (
        "REAL low = a < b ? a : b, high = a < b ? b : a, sum = low - (C(1.0) - high);\n"
        "    return sum > C(0.0) ? sum : C(0.0);"
    ),
    "drastic_product": "return a >= C(1.0) ? b : b >= C(1.0) ? a : C(0.0);",
    "einstein_product": "return a * b / (C(1.0) + (C(1.0) - a) * (C(1.0) - b));",
    "hamacher_product": "return a * b > C(0.0) ? a * b / (a + b - a * b) : C(0.0);",
    "nilpotent_minimum": (
        "REAL low = a < b ? a : b, high = a < b ? b : a;\n"
        "    return high >= C(1.0) || low - C(1e-15) > C(1.0) - high ? low : C(0.0);"
    ),
}
"""Bodies of f(a, b)."""

S_NORMS = {
    "max": "return a > b ? a : b;",
    "algebraic_sum": "return a + b - a * b;",
    "bounded_sum": "return a + b < C(1.0) ? a + b : C(1.0);",
    "drastic_sum": "return a <= C(0.0) ? b : b <= C(0.0) ? a : C(1.0);",
    "einstein_sum": "return (a + b) / (C(1.0) + a * b);",
    "hamacher_sum": (
        "REAL rest = (C(1.0) - a) + a * (C(1.0) - b);\n"
        "    return rest > C(0.0) ? (a * (C(1.0) - b) + b * (C(1.0) - a)) / rest : C(1.0);"
    ),
    "nilpotent_maximum": (
        "REAL low = a < b ? a : b, high = a < b ? b : a;\n"
        "    return low <= C(0.0) || low + C(1e-15) < C(1.0) - high ? high : C(1.0);"
    ),
    "sum": "return a + b;",
}
"""Bodies of f(a, b)."""

IMPLICATIONS = T_NORMS | {
    "bounded_sum": S_NORMS["bounded_sum"],
    "algebraic_sum": S_NORMS["algebraic_sum"],
    "kleene_dienes": "return C(1.0) - a > b ? C(1.0) - a : b;",
}
"""Bodies of f(firing strength, degree)."""

HEDGES = {
    "very": "return a * a;",
    "extremely": "return a * a * a;",
    "somewhat": "return M(sqrt)(a);",
    "more_or_less": "return M(pow)(a, C(1.0) / C(3.0));",
    "plus": "return M(pow)(a, C(1.25));",
    "intensify": ("return a <= C(0.5) ? C(2.0) * a * a : C(1.0) - C(2.0) * (C(1.0) - a) * (C(1.0) - a);"),
    "seldom": ("return a <= C(0.5) ? M(sqrt)(C(0.5) * a) : C(1.0) - M(sqrt)(C(0.5) * (C(1.0) - a));"),
    "any": "(void)a;\n    return C(1.0);",
}
"""Bodies of f(a)."""

_LIBRARY = ("exp", "pow", "fabs", "sqrt", "cos")


def two_argument_function(name: str, body: str) -> str:
    """Return the definition of f(a, b)."""
    return f"\nstatic REAL {name}(REAL a, REAL b)\n{{\n    {body}\n}}\n"


def one_argument_function(name: str, body: str) -> str:
    """Return the definition of f(a)."""
    return f"\nstatic REAL {name}(REAL a)\n{{\n    {body}\n}}\n"


def constant(value: float) -> str:
    """Return a number as a C constant; infinite ones as the greatest number, which no value reaches."""
    if math.isinf(value):
        return "BIG" if value > 0 else "-BIG"
    return f"C({value!r})"


class Shapes:
    """Membership functions as C expressions; remembers which functions and tables they need."""

    def __init__(self) -> None:
        self._functions: dict[str, str] = {}
        self._tables: list[str] = []

    def definitions(self) -> str:
        """Return the definitions of all functions that were used, and the tables of points."""
        return "".join(self._functions.values()) + "".join(self._tables)

    def degree(self, term: Term, x: str) -> str:
        """Return the degree of a term at ``x`` as an expression."""
        found = self._shape(term, x)
        if term.complement:
            found = f"(C(1.0) - {found})"
        return found if term.height == 1 else f"({constant(term.height)} * {found})"

    def _use(self, name: str, definition: str) -> str:
        self._functions.setdefault(name, definition)
        return name

    def _shape(self, term: Term, x: str) -> str:
        if isinstance(term.shape, Points):
            return self._points(term.shape, x)
        encoded = sets.encode(term)
        p = [constant(value) for value in encoded.parameters[:4]]
        match encoded.code:
            case codes.TRAPEZOID:
                return self._trapezoid([float(value) for value in encoded.parameters[:4]], x)
            case codes.GAUSSIAN:
                return _call(self._use("gaussian", _GAUSSIAN), x, p[:2])
            case codes.GAUSSIAN2:
                return _call(self._use("gaussian2", _GAUSSIAN2), x, p)
            case codes.BELL:
                return _call(self._use("bell", _BELL), x, p[:3])
            case codes.SIGMOID:
                return _call(self._use("sigmoid", _SIGMOID), x, p[:2])
            case codes.SIGMOID_DIFFERENCE | codes.SIGMOID_PRODUCT:
                one, other = (_call(self._use("sigmoid", _SIGMOID), x, pair) for pair in (p[:2], p[2:]))
                return f"({one} * {other})" if encoded.code == codes.SIGMOID_PRODUCT else f"M(fabs)({one} - {other})"
            case codes.PI_SHAPE:
                return self._pi_shape([float(value) for value in encoded.parameters[:4]], x)
            case codes.COSINE:
                return _call(self._use("cosine", _COSINE), x, p[:2])
            case codes.SPIKE:
                return _call(self._use("spike", _SPIKE), x, p[:2])
            case codes.CONCAVE:
                return _call(self._use("concave", _CONCAVE), x, p[:2])
            case _:
                raise AssertionError(f"an antecedent's set with the code {encoded.code}")

    def _trapezoid(self, corners: list[float], x: str) -> str:
        """Return a call; an open side has its top at the greatest number."""
        a, b, c, d = corners
        if math.isinf(a):
            a, b = -math.inf, -math.inf
        if math.isinf(d):
            c, d = math.inf, math.inf
        return _call(self._use("trapezoid", _TRAPEZOID), x, [constant(value) for value in (a, b, c, d)])

    def _pi_shape(self, corners: list[float], x: str) -> str:
        """Return the product of the sides that are there."""
        self._use("s_shape", _S_SHAPE)
        a, b, c, d = corners
        parts = []
        if math.isfinite(b):
            parts.append(f"s_shape({x} - {constant(a)}, {constant(b)} - {x}, {constant(b - a)})")
        if math.isfinite(c):
            parts.append(f"s_shape({constant(d)} - {x}, {x} - {constant(c)}, {constant(d - c)})")
        return f"({' * '.join(parts)})"

    def _points(self, shape: Points, x: str) -> str:
        self._use("points", _POINTS)
        number = len(self._tables)
        columns = ("place", [place for place, _ in shape.points]), ("degree", [degree for _, degree in shape.points])
        for name, values in columns:
            listed = ", ".join(constant(value) for value in values)
            self._tables.append(f"static const REAL {name}_{number}[{len(values)}] = {{{listed}}};\n")
        return f"points({x}, place_{number}, degree_{number}, {len(shape.points)})"


def _call(name: str, x: str, arguments: Iterable[str]) -> str:
    return f"{name}({', '.join((x, *arguments))})"


def needs_library(code: str) -> bool:
    """Return whether code calls a function of the C library."""
    return any(f"M({name})" in code for name in _LIBRARY)
