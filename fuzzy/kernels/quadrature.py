"""Area and first moment of an output set with curved terms, by adaptive Gauss-Kronrod quadrature.

Between the points where the leading set changes the integrand is analytic, so that the rule converges at once; an
interval is therefore divided where two sets cross, found by bisection, rather than in the middle.
"""

import math

import numpy as np

from fuzzy.kernels import exact, membership, norms
from fuzzy.kernels import tables as codes
from fuzzy.kernels.address import tables_at, workspace_at
from fuzzy.kernels.jit import kernel

_IMPLICATION = codes.IMPLICATION

TOLERANCE = 1e-13
"""Accepted difference of the two rules on an interval, as a share of the range (area) and of its square (moment)."""
_DEPTH = 48
"""Intervals waiting on the stack: each division halves, so 48 reach the resolution of a double."""

# Gauss-Kronrod 7-15: Kronrod, "Nodes and Weights of Quadrature Formulas", 1965; values as in QUADPACK's dqk15.
_NODE = np.array(
    [
        0.991455371120812639206854697526329,
        0.949107912342758524526189684047851,
        0.864864423359769072789712788640926,
        0.741531185599394439863864773280788,
        0.586087235467691130294144691693310,
        0.405845151377397166906606412076961,
        0.207784955007898467600689403773245,
        0.0,
    ]
)
_KRONROD = np.array(
    [
        0.022935322010529224963732008058970,
        0.063092092629978553290700663189204,
        0.104790010322250183839876322541518,
        0.140653259715525918745189590510238,
        0.169004726639267902826583426598550,
        0.190350578064785409913256402421014,
        0.204432940075298892414161999234649,
        0.209482141084727828012999174891714,
    ]
)
_GAUSS = np.array(
    [0.129484966168869693270611432679082, 0.279705391489276667901467771423780, 0.381830050505118944950369775488975,
     0.417959183673469387755102040816327]
)  # fmt: skip


@kernel
def leading(address, output, u):
    """Return the largest implied degree at ``u`` and the term that has it, by the max aggregation."""
    tables = tables_at(address)
    heights = workspace_at(address).height
    best = 0.0
    term = -1
    for k in range(tables.output_start[output], tables.output_start[output + 1]):
        if heights[k] > 0.0:
            degree = membership.degree(tables.output_shape[k], tables.output_parameter[k], u)
            implied = norms.t_norm(tables.options[_IMPLICATION], heights[k], degree)
            if implied > best:
                best = implied
                term = k
    return best, term


@kernel
def _handover(address, output, start, end):
    """Return a point between ``start`` and ``end`` at which the leading term changes, to the last bit."""
    first = leading(address, output, start)[1]
    for _ in range(60):
        middle = 0.5 * (start + end)
        if middle <= start or middle >= end:
            break
        if leading(address, output, middle)[1] == first:
            start = middle
        else:
            end = middle
    return end


@kernel
def _add_interval(address, output, start, end, origin):
    """Add the integral over [start, end], dividing until both rules agree."""
    tables = tables_at(address)
    moments = workspace_at(address).moments
    span = tables.output_range[output, 1] - tables.output_range[output, 0]
    lefts = np.empty(_DEPTH)
    rights = np.empty(_DEPTH)
    lefts[0] = start
    rights[0] = end
    waiting = 1
    while waiting > 0:
        waiting -= 1
        a = lefts[waiting]
        b = rights[waiting]
        centre = 0.5 * (a + b)
        half = 0.5 * (b - a)
        area = moment = coarse_area = coarse_moment = 0.0
        first_term = -1
        last_term = -1
        for n in range(15):
            j = n if n < 8 else 14 - n
            offset = half * _NODE[j] * (-1.0 if n < 7 else 1.0)
            degree, term = leading(address, output, centre + offset)
            if n == 0:
                first_term = term
            last_term = term
            first_moment = degree * (centre - origin + offset)
            area += _KRONROD[j] * degree
            moment += _KRONROD[j] * first_moment
            if j % 2 == 1:
                coarse_area += _GAUSS[j // 2] * degree
                coarse_moment += _GAUSS[j // 2] * first_moment
        error = max(abs(area - coarse_area) * half / span, abs(moment - coarse_moment) * half / (span * span))
        if error <= TOLERANCE or half <= 1e-15 * span or waiting + 2 > _DEPTH:
            moments[0] += half * area
            moments[1] += half * moment
            continue
        cut = centre
        if first_term != last_term:
            cut = _handover(address, output, centre - half * _NODE[0], centre + half * _NODE[0])
            if cut - a < 1e-12 * span or b - cut < 1e-12 * span:
                cut = centre
        lefts[waiting] = a
        rights[waiting] = cut
        lefts[waiting + 1] = cut
        rights[waiting + 1] = b
        waiting += 2


@kernel
def curved_moments(address, output):
    """Write area and moment of the upper envelope of sets of which at least one is curved.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        output: Number of the output.
    """
    tables = tables_at(address)
    workspace = workspace_at(address)
    heights = workspace.height
    scratch = workspace.scratch
    low = tables.output_range[output, 0]
    high = tables.output_range[output, 1]
    count = 0
    for i in range(tables.break_start[output], tables.break_start[output + 1]):
        scratch[count] = tables.break_point[i]
        count += 1
    if tables.options[_IMPLICATION] == norms.MIN:
        for k in range(tables.output_start[output], tables.output_start[output + 1]):
            if heights[k] <= 0.0 or heights[k] >= 1.0:
                continue
            p = tables.output_parameter[k]
            if tables.output_shape[k] == membership.GAUSSIAN:
                reach = p[1] * math.sqrt(-2.0 * math.log(heights[k]))
                scratch[count] = p[0] - reach
                scratch[count + 1] = p[0] + reach
            else:
                scratch[count] = p[0] + heights[k] * (p[1] - p[0]) if p[0] > -math.inf else low
                scratch[count + 1] = p[3] - heights[k] * (p[3] - p[2]) if p[3] < math.inf else high
            count += 2
    exact.sort(scratch, count)
    origin = 0.5 * (low + high)
    for i in range(count - 1):
        start = max(scratch[i], low)
        end = min(scratch[i + 1], high)
        if end > start:
            _add_interval(address, output, start, end, origin)
