"""The numbers by which compiled systems name shapes, operators of rules, and methods of outputs."""

TRAPEZOID = 0
"""(a, b, c, d): 0 outside [a, d], 1 on [b, c], linear between; an infinite a or d is an open shoulder."""
GAUSSIAN = 1
"""(mean, sigma, -, -)."""
GAUSSIAN2 = 2
"""(left mean, left sigma, right mean, right sigma)."""
BELL = 3
"""(center, width, slope, -)."""
SIGMOID = 4
"""(center, slope, -, -)."""
SIGMOID_DIFFERENCE = 5
"""(left center, left slope, right center, right slope)."""
SIGMOID_PRODUCT = 6
"""(left center, left slope, right center, right slope)."""
PI_SHAPE = 7
"""(a, b, c, d): rises from a to b, falls from c to d; an infinite side is open."""
COSINE = 8
"""(center, width, -, -)."""
SPIKE = 9
"""(center, width, -, -)."""
CONCAVE = 10
"""(inflection, end, -, -)."""
POINTS = 11
"""(first value, n, -, -): n places and then their degrees among the values beside the table."""
LINEAR = 12
"""(first value, n, -, -): n coefficients and a constant among the values beside the table; a function, no set."""
LINE = -1
"""(origin, run, offset, -): offset + (x - origin) / run, a piece of a piecewise-linear shape."""

OFFSET, SCALE, PEAK = 4, 5, 6
"""Columns behind the four parameters: the degree is offset + scale · the shape's; where a curve stops rising."""
WIDTH = 8
"""Columns of a row of parameters."""

MOST_BENDS = 40
"""Greatest number of points that ``bends`` appends for a set that is not given by points."""

CLIPPED = 0
"""Method of an output: min and max, at most two neighbouring sets overlap anywhere: polynomials of the heights."""
SEPARATE = 1
"""Method of an output: sum aggregation, each rule's own set in closed form."""
ENVELOPE = 2
"""Method of an output: upper envelope of piecewise-linear sets, exact."""
QUADRATURE = 3
"""Method of an output: sets of which some are curved, adaptive Gauss-Kronrod."""
SAMPLED = 4
"""Method of an output: samples of the aggregated set, as other engines do."""
WEIGHTED_AVERAGE = 5
WEIGHTED_SUM = 6
"""Methods of an output: its terms' values, weighted by their levels."""
LINEAR_CENTROID = 7
LINEAR_BISECTOR = 8
LINEAR_MAXIMA = 9
"""Methods of an output: any aggregate of straight lines, exact."""
CURVED_BISECTOR = 10
CURVED_MAXIMA = 11
"""Methods of an output: sets of which some are curved, and operators that bend lines."""
SAMPLED_BISECTOR = 12
SAMPLED_MAXIMA = 13
"""Methods of an output: over samples, as other engines do."""
POLYGON_CENTROID = 14
POLYGON_BISECTOR = 15
POLYGON_MAXIMA = 16
"""Methods of an output: the polygon through samples and the points where sets are clipped, as scikit-fuzzy does."""

CURVED = frozenset({QUADRATURE, CURVED_BISECTOR, CURVED_MAXIMA})
"""Methods that follow the bends of curved sets."""

MEAN = 0
SMALLEST = 1
LARGEST = 2
SMALLEST_MAGNITUDE = 3
LARGEST_MAGNITUDE = 4
"""Which of the places at which the aggregated set is largest."""

LARGEST_STRENGTH = 0
SUM_OF_STRENGTHS = 1
EVERY_CONSEQUENT = 2
"""Grouping: a term is one member of an output's set, at its largest strength or their sum, or one for each rule."""

DEFAULT = 0
HOLD = 1
"""Policies of an output for which no rule fires: a fixed value (midpoint and NaN are such), or the last output."""

NOT = -1
AND = -2
OR = -3
ALL = -4
HEDGE = -5
"""Operators in ``RuleTables.program``: ``ALL`` joins everything before it by AND, and that is input terms only, so that
no stack is needed; ``HEDGE`` - n is the hedge of code n. A number from 0 on pushes the degree of
that input term, one from the number of input terms on how far an output term is activated by the rules before."""
