"""Exact areas and first moments of output sets.

Every set is cut into level sets: {u : degree(u) >= t} has a width w(t) and a first moment m(t), which for a
piecewise-linear set are a linear and a quadratic function of the level t between two vertex heights. The set
clipped at height h thus has the area A(h) = ∫ w dt and the moment M(h) = ∫ m dt over 0 <= t <= h: a quadratic and a
cubic polynomial in h, whose coefficients are computed once, when a system is compiled. Moments are taken about the
middle of the output's range, where they cancel least.
"""

import math

from fuzzy.kernels import membership, norms
from fuzzy.kernels import tables as codes
from fuzzy.kernels.address import tables_at, workspace_at
from fuzzy.kernels.jit import kernel

_SQRT_HALF = math.sqrt(0.5)
_SQRT_HALF_PI = math.sqrt(0.5 * math.pi)
_IMPLICATION = codes.IMPLICATION


@kernel
def cut_polynomials(left, right, low, high, knot, cut):
    """Write the polynomials of area and moment of a clipped piecewise-linear set.

    Args:
        left: (n,) left ends of the set's linear pieces, about the middle of the range.
        right: (n,) right ends.
        low: (n,) degrees at the left ends.
        high: (n,) degrees at the right ends.
        knot: (n_knots,) the distinct degrees of all ends in ascending order, the first 0, the last the set's height.
        cut: (n_knots, 8) out, one row for each level t from ``knot[i]`` on: t, A, A', A''/2, M, M', M''/2, M'''/6
            at that level. The last row is constant: above its height nothing is clipped.
    """
    area = 0.0
    moment = 0.0
    last = knot.size - 1
    for i in range(last):
        t = knot[i]
        step = knot[i + 1] - t
        # w(t + d) = w0 + w1 d and m(t + d) = m0 + m1 d + m2 d², summed over the pieces.
        w0 = w1 = m0 = m1 = m2 = 0.0
        for k in range(left.size):
            bottom = min(low[k], high[k])
            top = max(low[k], high[k])
            width = right[k] - left[k]
            if top <= t or width <= 0.0:
                continue
            if bottom > t:  # this piece lies wholly above the level
                w0 += width
                m0 += 0.5 * (left[k] + right[k]) * width
                continue
            # Only the part next to the higher end is above the level: its far end moves by slope · d.
            slope = width / (top - bottom)
            reach = slope * (top - t)
            w0 += reach
            w1 -= slope
            if high[k] >= low[k]:  # from right[k] - reach to right[k]
                m0 += reach * (right[k] - 0.5 * reach)
                m1 -= slope * (right[k] - reach)
                m2 -= 0.5 * slope * slope
            else:
                m0 += reach * (left[k] + 0.5 * reach)
                m1 -= slope * (left[k] + reach)
                m2 += 0.5 * slope * slope
        cut[i, 0] = t
        cut[i, 1] = area
        cut[i, 2] = w0
        cut[i, 3] = w1 / 2.0
        cut[i, 4] = moment
        cut[i, 5] = m0
        cut[i, 6] = m1 / 2.0
        cut[i, 7] = m2 / 3.0
        area += step * (w0 + step * w1 / 2.0)
        moment += step * (m0 + step * (m1 / 2.0 + step * m2 / 3.0))
    cut[last, :] = 0.0
    cut[last, 0] = knot[last]
    cut[last, 1] = area
    cut[last, 4] = moment


@kernel
def add_clipped(address, index, height, sign):
    """Add a set clipped at ``height`` to ``workspace.moments``, times ``sign``."""
    tables = tables_at(address)
    moments = workspace_at(address).moments
    first = tables.cut_start[index]
    row = tables.cut_start[index + 1] - 1
    while row > first and tables.cut[row, 0] > height:
        row -= 1
    cut = tables.cut[row]
    d = height - cut[0]
    moments[0] += sign * (cut[1] + d * (cut[2] + d * cut[3]))
    moments[1] += sign * (cut[4] + d * (cut[5] + d * (cut[6] + d * cut[7])))


@kernel
def clipped_moments(address, output):
    """Write area and moment of the union of clipped sets of which only neighbours overlap.

    max = Σ min(h_k, μ_k) - Σ min(h_k, h_k+1, μ_k, μ_k+1), since no three sets overlap.
    """
    tables = tables_at(address)
    heights = workspace_at(address).height
    for k in range(tables.output_start[output], tables.output_start[output + 1]):
        if heights[k] > 0.0:
            add_clipped(address, k, heights[k], 1.0)
            right = tables.neighbour[k]
            if right >= 0 and heights[right] > 0.0:
                add_clipped(address, heights.size + k, min(heights[k], heights[right]), -1.0)


@kernel
def _gaussian_moments(p, low, high, origin, moments):
    """Return area and moment about ``origin`` of exp(-(u - mean)²/(2 sigma²)) on [low, high]."""
    a = (low - p[0]) / p[1]
    b = (high - p[0]) / p[1]
    area = p[1] * _SQRT_HALF_PI * (math.erf(b * _SQRT_HALF) - math.erf(a * _SQRT_HALF))
    moments[0] += area
    moments[1] += area * (p[0] - origin) + p[1] * p[1] * (math.exp(-0.5 * a * a) - math.exp(-0.5 * b * b))


@kernel
def _add_clipped_gaussian(p, low, high, origin, height, moments):
    """Add area and moment about ``origin`` of a Gaussian clipped at ``height`` on [low, high]."""
    reach = p[1] * math.sqrt(-2.0 * math.log(height)) if height < 1.0 else 0.0
    start = min(max(p[0] - reach, low), high)
    end = min(max(p[0] + reach, low), high)
    _gaussian_moments(p, low, start, origin, moments)
    _gaussian_moments(p, end, high, origin, moments)
    moments[0] += height * (end - start)
    moments[1] += height * (end - start) * (0.5 * (start + end) - origin)


@kernel
def separate_moments(address, fired, output):
    """Write area and moment of the sum of the fired rules' own sets (paper eq. (32)).

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        fired: How many rules fire.
        output: Number of the output.
    """
    tables = tables_at(address)
    workspace = workspace_at(address)
    moments = workspace.moments
    low = tables.output_range[output, 0]
    high = tables.output_range[output, 1]
    origin = 0.5 * (low + high)
    for i in range(fired):
        rule = workspace.fired[i]
        strength = workspace.strength[rule]
        for c in range(tables.consequent_start[rule], tables.consequent_start[rule + 1]):
            k = tables.consequent_term[c]
            if k < tables.output_start[output] or k >= tables.output_start[output + 1]:
                continue
            scaled = tables.options[_IMPLICATION] == norms.PRODUCT
            before_area = moments[0]
            before_moment = moments[1]
            height = 1.0 if scaled else strength
            if tables.output_shape[k] == membership.GAUSSIAN:
                _add_clipped_gaussian(tables.output_parameter[k], low, high, origin, height, moments)
            else:
                add_clipped(address, k, height, 1.0)
            if scaled:
                moments[0] = before_area + strength * (moments[0] - before_area)
                moments[1] = before_moment + strength * (moments[1] - before_moment)


@kernel
def _segment(address, output, i, start, end):
    """Add the envelope on [start, end] in break interval ``i``, where it is one straight line."""
    tables = tables_at(address)
    workspace = workspace_at(address)
    heights = workspace.height
    moments = workspace.moments
    first = tables.break_start[output]
    left = tables.break_point[first + i]
    width = tables.break_point[first + i + 1] - left
    at_start = 0.0
    at_end = 0.0
    for k in range(tables.output_start[output], tables.output_start[output + 1]):
        if heights[k] <= 0.0:
            continue
        edge = tables.edge[tables.edge_start[k] + i]
        slope = (edge[1] - edge[0]) / width
        a = norms.t_norm(tables.options[_IMPLICATION], heights[k], edge[0] + slope * (start - left))
        b = norms.t_norm(tables.options[_IMPLICATION], heights[k], edge[0] + slope * (end - left))
        # The line that is largest in the middle is so on the whole segment: none cross inside it.
        if a + b > at_start + at_end:
            at_start = a
            at_end = b
    origin = 0.5 * (tables.output_range[output, 0] + tables.output_range[output, 1])
    length = end - start
    moments[0] += 0.5 * length * (at_start + at_end)
    centre = 0.5 * (start + end) - origin
    moments[1] += 0.5 * length * (at_start + at_end) * centre + length * length * (at_end - at_start) / 12.0


@kernel
def envelope_moments(address, output):
    """Write area and moment of the upper envelope of clipped or scaled piecewise-linear sets (paper eq. (31)).

    Each interval between break points is divided where a set bends at its height and where two sets cross; between
    these points the envelope is a straight line.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        output: Number of the output.
    """
    tables = tables_at(address)
    workspace = workspace_at(address)
    heights = workspace.height
    scratch = workspace.scratch
    first = tables.break_start[output]
    begin = tables.output_start[output]
    stop = tables.output_start[output + 1]
    clips = tables.options[_IMPLICATION] == norms.MIN
    for i in range(tables.break_start[output + 1] - first - 1):
        left = tables.break_point[first + i]
        right = tables.break_point[first + i + 1]
        count = 0
        for k in range(begin, stop):
            if heights[k] <= 0.0:
                continue
            edge_k = tables.edge[tables.edge_start[k] + i]
            if edge_k[0] <= 0.0 and edge_k[1] <= 0.0:
                continue
            if clips:
                count = _add_crossing(edge_k[0] - heights[k], edge_k[1] - heights[k], scratch, count)
            for n in range(k + 1, stop):
                if heights[n] <= 0.0:
                    continue
                edge_n = tables.edge[tables.edge_start[n] + i]
                gain_k = 1.0 if clips else heights[k]
                gain_n = 1.0 if clips else heights[n]
                count = _add_crossing(
                    gain_k * edge_k[0] - gain_n * edge_n[0], gain_k * edge_k[1] - gain_n * edge_n[1], scratch, count
                )
                if clips:  # one's plateau against the other's side
                    count = _add_crossing(edge_k[0] - heights[n], edge_k[1] - heights[n], scratch, count)
                    count = _add_crossing(edge_n[0] - heights[k], edge_n[1] - heights[k], scratch, count)
        start = left
        sort(scratch, count)
        for c in range(count):
            end = left + scratch[c] * (right - left)
            if end > start:
                _segment(address, output, i, start, end)
                start = end
        _segment(address, output, i, start, right)


@kernel
def _add_crossing(a, b, scratch, count):
    """Append the place in (0, 1) at which a line from ``a`` to ``b`` is 0, if it changes sign; return the new count."""
    if (a < 0.0 < b) or (b < 0.0 < a):
        scratch[count] = a / (a - b)
        return count + 1
    return count


@kernel
def sort(values, count):
    """Sort the first ``count`` values in place by insertion: they are few."""
    for i in range(1, count):
        value = values[i]
        j = i - 1
        while j >= 0 and values[j] > value:
            values[j + 1] = values[j]
            j -= 1
        values[j + 1] = value
