"""The compiled form of a fuzzy system: arrays, in which every name has become an index."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Integers = NDArray[np.int64]
Numbers = NDArray[np.float64]

CONJUNCTION, DISJUNCTION, IMPLICATION, AGGREGATION, SAMPLES, SAMPLING = range(6)
"""Places in ``Tables.options``."""

MIDPOINTS = 0
ENDPOINTS = 1
"""Sampling rules."""

CLIPPED = 0
"""Method of an output: min and max, at most two neighbouring sets overlap anywhere: polynomials of the heights."""
SEPARATE = 1
"""Method of an output: sum aggregation, each rule's own set in closed form."""
ENVELOPE = 2
"""Method of an output: upper envelope of piecewise-linear sets, exact."""
QUADRATURE = 3
"""Method of an output: upper envelope with curved sets, adaptive Gauss-Kronrod."""
SAMPLED = 4
"""Method of an output: samples of the aggregated set, as other engines do."""

DEFAULT = 0
HOLD = 1
"""Policies of an output for which no rule fires: a fixed value (midpoint and NaN are such), or the last output."""

NOT = -1
AND = -2
OR = -3
"""Operators in ``Tables.program``; a number from 0 on pushes the degree of that input term."""


class Tables(NamedTuple):
    """A compiled system; all arrays are read-only. n_in inputs, n_out outputs.

    Terms are numbered through, variable by variable; rules are numbered as ``fuzzy.rules.all_rules`` numbers them,
    the cells of the table first. Sets are the n_output_terms output terms, followed by as many overlaps: set
    n_output_terms + k is the intersection of term k and its right-hand neighbour (see ``neighbour``).
    """

    options: Integers  # (6,) operator codes and sampling
    input_range: Numbers  # (n_in, 2) low, high
    input_rejects: Integers  # (n_in,) 1 where a value outside the range is refused
    input_start: Integers  # (n_in + 1,) first term of each input
    input_shape: Integers  # (n_input_terms,) membership code
    input_parameter: Numbers  # (n_input_terms, 4)
    grid: Integers  # (n_rows, n_columns) rule of each cell, -1 for none
    grid_origin: Integers  # (2,) input term of the first row and of the first column
    program: Integers  # (n_program,) antecedents of the listed rules in postfix order
    program_start: Integers  # (n_listed + 1,)
    weight: Numbers  # (n_listed,)
    consequent_start: Integers  # (n_rules + 1,)
    consequent_term: Integers  # (n_consequents,) output term
    output_range: Numbers  # (n_out, 2)
    output_start: Integers  # (n_out + 1,) first term of each output
    output_shape: Integers  # (n_output_terms,)
    output_parameter: Numbers  # (n_output_terms, 4)
    method: Integers  # (n_out,) CLIPPED ... SAMPLED
    no_fire: Integers  # (n_out,) DEFAULT or HOLD
    no_fire_value: Numbers  # (n_out,)
    neighbour: Integers  # (n_output_terms,) next term to the right, -1 for none
    cut_start: Integers  # (2 n_output_terms + 1,) first row of each set in ``cut``
    cut: Numbers  # (n_pieces, 8) area and moment of a clipped set, see ``exact.cut_polynomials``
    break_start: Integers  # (n_out + 1,) first of each output's break points
    break_point: Numbers  # (n_breaks,) ascending for each output, both ends of the range included
    edge_start: Integers  # (n_output_terms,) first row of each term in ``edge``
    edge: Numbers  # (n_edges, 2) degrees at both ends inside each interval between break points


class Workspace(NamedTuple):
    """What one inference writes, so that a picture shows what the controller did."""

    input: Numbers  # (n_in,) crisp inputs of a call without arrays
    output: Numbers  # (n_out,) its crisp outputs, kept for the hold policy
    membership: Numbers  # (n_input_terms,) degrees of the input terms
    strength: Numbers  # (n_rules,) firing strengths times weights
    fired: Integers  # (n_rules,) the numbers of the rules that fired, in the first places
    height: Numbers  # (n_output_terms,) aggregated strength of each output term
    stack: Numbers  # (n_stack,) operands of an antecedent
    moments: Numbers  # (2,) area and first moment of the output set
    scratch: Numbers  # (n_scratch,)


def new_workspace(tables: Tables) -> Workspace:
    """Return a workspace for one thread that evaluates ``tables``; its outputs start with their no-fire values."""
    n_rules = tables.consequent_start.size - 1
    n_terms = tables.output_shape.size
    # Bends within one interval between break points: three for each pair of sets; or all bends of the curved sets.
    n_scratch = max(3 * n_terms * (n_terms + 1) // 2, tables.break_point.size + 2 * n_terms)
    return Workspace(
        input=np.zeros(len(tables.input_range)),
        output=tables.no_fire_value.copy(),
        membership=np.zeros(tables.input_shape.size),
        strength=np.zeros(n_rules),
        fired=np.zeros(n_rules, dtype=np.int64),
        height=np.zeros(n_terms),
        stack=np.zeros(tables.program.size + 1),
        moments=np.zeros(2),
        scratch=np.zeros(n_scratch),
    )
