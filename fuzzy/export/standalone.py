"""Inference in plain Python and numpy. Exported controllers carry a copy of this text behind their tables."""

import itertools
import math

import numpy as np


def sigmoid(x, center, slope):
    """Return 1 / (1 + exp(-slope (x - center)))."""
    return 1.0 / (1.0 + np.exp(np.clip(-slope * (x - center), -700.0, 700.0)))


def s_shape(x, a, b):
    """Return two parabolas from 0 at ``a`` to 1 at ``b``."""
    width = b - a if b > a else 1.0
    rising = np.where(x - a <= b - x, 2.0 * ((x - a) / width) ** 2, 1.0 - 2.0 * ((b - x) / width) ** 2)
    return np.where(x >= b, 1.0, np.where(x <= a, 0.0, rising))


def trapezoid(x, a, b, c, d):
    """Return a trapezoid's degree; infinite sides are open, vertical ones closed."""
    rise = (x - a) / (b - a) if math.isfinite(a) and b > a else 1.0
    fall = (d - x) / (d - c) if math.isfinite(d) and d > c else 1.0
    found = np.where(x < b, rise, np.where(x > c, fall, 1.0))
    outside = ((x <= a) & (x < b)) | ((x >= d) & (x > c))
    return np.where(outside, 0.0, found)


def points(x, *values):
    """Return lines through (x1, degree1), (x2, degree2) ..., the larger degree at a jump."""
    places, degrees = np.array(values[::2]), np.array(values[1::2])
    found = np.interp(x, places, degrees)
    for place in places:
        found = np.where(x == place, degrees[places == place].max(), found)
    return found


def concave(x, inflection, end):
    """Return a hyperbola, 1/2 at ``inflection`` and 1 from ``end`` on."""
    inside = (x < end) if inflection < end else (x >= end)
    return np.where(inside, (end - inflection) / np.where(inside, 2.0 * end - inflection - x, 1.0), 1.0)


SHAPES = {
    "triangle": lambda x, a, b, c: trapezoid(x, a, b, b, c),
    "trapezoid": trapezoid,
    "rectangle": lambda x, a, b: np.where((x >= a) & (x <= b), 1.0, 0.0),
    "ramp": lambda x, start, end: np.clip((x - start) / (end - start), 0.0, 1.0),
    "singleton": lambda x, value: np.where(x == value, 1.0, 0.0),
    "points": points,
    "gaussian": lambda x, mean, sigma: np.exp(-0.5 * ((x - mean) / sigma) ** 2),
    "gaussian2": lambda x, m1, s1, m2, s2: np.exp(
        -0.5
        * (
            np.where(x < m1, (x - max(m1, -1e300)) / s1, 0.0) ** 2
            + np.where(x > m2, (x - min(m2, 1e300)) / s2, 0.0) ** 2
        )
    ),
    "bell": lambda x, center, width, slope: 1.0 / (1.0 + np.abs((x - center) / width) ** (2.0 * slope)),
    "sigmoid": sigmoid,
    "sigmoid_difference": lambda x, a, b, c, d: np.abs(sigmoid(x, a, b) - sigmoid(x, c, d)),
    "sigmoid_product": lambda x, a, b, c, d: sigmoid(x, a, b) * sigmoid(x, c, d),
    "s_shape": s_shape,
    "z_shape": lambda x, a, b: s_shape(-x, -b, -a),
    "pi_shape": lambda x, a, b, c, d: s_shape(x, a, b) * s_shape(-x, -d, -c),
    "cosine": lambda x, center, width: np.where(
        np.abs((x - center) / width) <= 0.5, 0.5 * (1.0 + np.cos(2.0 * math.pi * (x - center) / width)), 0.0
    ),
    "spike": lambda x, center, width: np.exp(-np.abs(10.0 / width * (x - center))),
    "concave": concave,
}

T_NORMS = {
    "min": np.minimum,
    "product": lambda a, b: a * b,
    "bounded_difference": lambda a, b: np.maximum(0.0, np.minimum(a, b) - (1.0 - np.maximum(a, b))),
    "drastic_product": lambda a, b: np.where(np.maximum(a, b) >= 1.0, np.minimum(a, b), 0.0),
    "einstein_product": lambda a, b: a * b / (1.0 + (1.0 - a) * (1.0 - b)),
    "hamacher_product": lambda a, b: np.where(a * b > 0.0, a * b / np.where(a * b > 0.0, a + b - a * b, 1.0), 0.0),
    "nilpotent_minimum": lambda a, b: np.where(
        (np.maximum(a, b) >= 1.0) | (np.minimum(a, b) - 1e-15 > 1.0 - np.maximum(a, b)), np.minimum(a, b), 0.0
    ),
}

S_NORMS = {
    "max": np.maximum,
    "algebraic_sum": lambda a, b: a + b - a * b,
    "bounded_sum": lambda a, b: np.minimum(1.0, a + b),
    "drastic_sum": lambda a, b: np.where(np.minimum(a, b) <= 0.0, np.maximum(a, b), 1.0),
    "einstein_sum": lambda a, b: (a + b) / (1.0 + a * b),
    "hamacher_sum": lambda a, b: np.where(
        a * b < 1.0, (a * (1.0 - b) + b * (1.0 - a)) / np.where(a * b < 1.0, (1.0 - a) + a * (1.0 - b), 1.0), 1.0
    ),
    "nilpotent_maximum": lambda a, b: np.where(
        (np.minimum(a, b) <= 0.0) | (np.minimum(a, b) + 1e-15 < 1.0 - np.maximum(a, b)), np.maximum(a, b), 1.0
    ),
    "sum": lambda a, b: a + b,
}

IMPLICATIONS = T_NORMS | {
    "bounded_sum": S_NORMS["bounded_sum"],
    "algebraic_sum": S_NORMS["algebraic_sum"],
    "kleene_dienes": lambda w, a: np.maximum(1.0 - w, a),
}

HEDGES = {
    "very": lambda a: a**2,
    "extremely": lambda a: a**3,
    "somewhat": math.sqrt,
    "more_or_less": lambda a: a ** (1.0 / 3.0),
    "plus": lambda a: a**1.25,
    "intensify": lambda a: 2.0 * a * a if a <= 0.5 else 1.0 - 2.0 * (1.0 - a) ** 2,
    "seldom": lambda a: math.sqrt(0.5 * a) if a <= 0.5 else 1.0 - math.sqrt(0.5 * (1.0 - a)),
    "any": lambda _: 1.0,
}


def degree(term, x):
    """Return the degree of (kind, parameters, height, complement) at a number or at an array."""
    kind, parameters, height, complement = term
    found = SHAPES[kind](x, *parameters)
    return height * (1.0 - found if complement else found)


def expression(system, node, degrees):
    """Return the degree of an antecedent: "is" input term, "not" e, "hedge" word e, "and" or "or" [e ...]."""
    match node[0]:
        case "is":
            return degrees[node[1]][node[2]]
        case "not":
            return 1.0 - expression(system, node[1], degrees)
        case "hedge":
            return HEDGES[node[1]](expression(system, node[2], degrees))
    join = T_NORMS[system["and"]] if node[0] == "and" else S_NORMS[system["or"]]
    found = expression(system, node[1][0], degrees)
    for operand in node[1][1:]:
        found = float(join(found, expression(system, operand, degrees)))
    return found


def weighted(output, members, inputs):
    """Return Σ w z / Σ w, or Σ w z, of constants and linear functions of the inputs."""
    weight = moment = 0.0
    for strength, term in members:
        value = output["values"][term]
        if not isinstance(value, float):
            value = value[-1] + sum(factor * x for factor, x in zip(value, inputs, strict=False))
        weight += strength
        moment += strength * value
    if not weight > 0.0:
        return None
    return moment if output["method"] == "weighted_sum" else moment / weight


def sampled(system, output, members):
    """Return Σ u μ(u) / Σ μ(u) over the samples of the aggregated set."""
    u, weight = np.array(output["samples"]).T
    total = np.zeros(u.size)
    for strength, term in members:
        implied = IMPLICATIONS[system["implication"]](strength, degree(output["terms"][term], u))
        total = S_NORMS[system["aggregation"]](total, implied)
    total = total * weight
    middle = 0.5 * (output["low"] + output["high"])
    area = total.sum()
    return middle + ((u - middle) * total).sum() / area if area > 0.0 else None


def exact(system, output, members):
    """Return the centroid of piecewise-linear sets, in closed form between the points where their aggregate bends."""
    scales = system["implication"] == "product"
    middle = 0.5 * (output["low"] + output["high"])
    area = moment = 0.0
    groups = [members] if system["aggregation"] == "max" else [[member] for member in members]
    for group in groups:
        for left, right, sides in output["intervals"]:
            lines = []
            for strength, term in group:
                if term in sides:
                    factor = strength if scales else 1.0
                    lines.append((factor * sides[term][0], factor * sides[term][1], strength))
            if not lines:
                continue
            crossed = [(start, end) for start, end, _ in lines] + [(cap, cap) for _, _, cap in lines]
            cuts = {0.0, 1.0}
            for (a, b), (c, d) in itertools.combinations(crossed, 2):
                if (a - c) * (b - d) < 0.0:
                    cuts.add((a - c) / ((a - c) - (b - d)))
            ordered = sorted(cuts)
            heights = [max(min(a + t * (b - a), cap) for a, b, cap in lines) for t in ordered]
            for t, s, first, second in zip(ordered, ordered[1:], heights, heights[1:], strict=False):
                width = (s - t) * (right - left)
                start = left + t * (right - left) - middle
                area += 0.5 * width * (first + second)
                moment += width * (0.5 * start * (first + second) + width * (first + 2.0 * second) / 6.0)
    return middle + moment / area if area > 0.0 else None


METHODS = {"sampled": sampled, "exact": exact}
"""Defuzzifiers over sets: f(system, output, members)."""


def evaluate(system, inputs, last=None):
    """Return the crisp outputs, one for each output of the system.

    Args:
        system: The tables.
        inputs: Crisp inputs, in order; those outside their range count as its nearer end.
        last: The last outputs, which an output that holds keeps when no rule fires.
    """
    if len(inputs) != len(system["inputs"]) or not all(math.isfinite(x) for x in inputs):
        raise ValueError(f"{inputs}: expected {len(system['inputs'])} finite numbers")
    limited = [
        min(max(float(x), entry["low"]), entry["high"]) for x, entry in zip(inputs, system["inputs"], strict=True)
    ]
    degrees = [
        [float(degree(term, x)) for term in entry["terms"]] for x, entry in zip(limited, system["inputs"], strict=True)
    ]
    strengths = [weight * expression(system, antecedent, degrees) for antecedent, weight, _ in system["rules"]]
    results = []
    for number, output in enumerate(system["outputs"]):
        fired = [
            (strength, term)
            for strength, (_, _, conclusions) in zip(strengths, system["rules"], strict=True)
            for place, term in conclusions
            if place == number and strength > 0.0
        ]
        if output["joins"]:
            largest = {}
            for strength, term in fired:
                largest[term] = max(strength, largest.get(term, 0.0))
            fired = [(strength, term) for term, strength in largest.items()]
        method = METHODS.get(output["method"])
        value = weighted(output, fired, limited) if method is None else method(system, output, fired)
        if value is None:
            value = output["silent"] if output["silent"] is not None or last is None else last[number]
            value = 0.5 * (output["low"] + output["high"]) if value is None else value
        elif output["limits"]:
            value = min(max(value, output["low"]), output["high"])
        results.append(float(value))
    return tuple(results)
