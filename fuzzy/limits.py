"""How large a document may be."""

MAX_VARIABLES = 16
"""Greatest number of inputs, and of outputs."""

MAX_TERMS = 64
"""Greatest number of terms of an input."""

MAX_OUTPUT_TERMS = 256
"""Greatest number of terms of an output: a Sugeno system has one for each rule."""

MAX_RULES = 4096
"""Greatest number of rules, table and list together."""

MAX_NAME = 64
"""Greatest length of a name or a unit, in characters."""

MAX_NOTES = 20_000
"""Greatest length of the notes, in characters."""

MAX_VALUE = 1e12
"""Greatest magnitude of a range's end or a shape's parameter: squares and differences keep their digits."""

MIN_RELATIVE_WIDTH = 1e-9
"""Least width of a range over its magnitude, and of an output term's set over its range."""

MIN_WIDTH = 1e-12
"""Least width of a range."""

MIN_POINTS, MAX_POINTS = 2, 100_000
"""Numbers of samples that a sampled defuzzifier may take."""
