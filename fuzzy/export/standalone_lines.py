"""Exact aggregates of straight lines in plain Python. Exported controllers that need it carry a copy of this text.

The kernels that it calls are copied, too, as :mod:`fuzzy.export.kernel_source` gives them.
"""

import numpy as np

from fuzzy.kernels.exact import sort as exact_sort
from fuzzy.kernels.linear import add_bend as linear_add_bend
from fuzzy.kernels.linear import imply as linear_imply
from fuzzy.kernels.linear import join as linear_join
from fuzzy.kernels.norms import bend_level as norms_bend_level
from fuzzy.kernels.pieces import begin as pieces_begin
from fuzzy.kernels.pieces import top as pieces_top

AREA, HALF, TOP = 0, 1, 2
SUM, MOMENT, TARGET, PLACE, BEST = 0, 1, 2, 4, 0


def followed(output, members, question, account):
    """Enter all straight parts of the aggregated set into the account."""
    code = output["implication"]
    origin = 0.5 * (output["low"] + output["high"])
    places = np.empty(2 * len(members) + 1)
    pieces_begin(account, question)
    for left, right, sides in output["intervals"]:
        terms = [(strength, *sides.get(term, (0.0, 0.0))) for strength, term in members]
        count = 0
        for strength, first, last in terms:
            count = linear_add_bend(first, last, norms_bend_level(code, strength), places, count)
            if output["bends_twice"]:
                count = linear_add_bend(first, last, strength, places, count)
        exact_sort(places, count)
        places[count] = 1.0
        start = 0.0
        for end in places[: count + 1].tolist():
            if end <= start:
                continue
            lines = np.empty(2 * len(terms))
            for m, (strength, first, last) in enumerate(terms):
                slope, centre = last - first, 0.5 * (start + end)
                value, rise = linear_imply(code, 1.0, strength, first + centre * slope, slope)
                lines[2 * m], lines[2 * m + 1] = value - (centre - start) * rise, rise
            joined = output["least"], output["aggregation"], lines
            linear_join(account, question, origin, *joined, left, right - left, start, end)
            start = end


def straight(_, output, members):
    """Return the centroid, the bisector or a maximum of the aggregated set."""
    account = np.zeros(10)
    if output["which"] >= 0:
        followed(output, members, TOP, account)
        return pieces_top(account, output["which"]) if account[BEST] > 0.0 else None
    followed(output, members, AREA, account)
    area = account[SUM]
    if not area > 0.0:
        return None
    if not output["halves"]:
        return 0.5 * (output["low"] + output["high"]) + account[MOMENT] / area
    account[TARGET] = 0.5 * area
    followed(output, members, HALF, account)
    return account[PLACE]
