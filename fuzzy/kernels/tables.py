"""The compiled form of a fuzzy system: arrays, in which every name has become an index."""

import functools
import itertools
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzy.kernels import codes

Integers = NDArray[np.int64]
Numbers = NDArray[np.float64]


class InputTables(NamedTuple):
    """Fuzzification: n_in inputs with n_terms terms, numbered through.

    An input's knots, where any of its piecewise-linear sets bends or jumps, divide its range into cells: m knots and
    the m + 1 open intervals around them in ascending order, so that cell 2i + 1 is knot i alone. Within a cell every
    such set is one straight line, a piece; pieces that are 0 are left out.
    """

    range: Numbers  # (n_in, 2) low, high
    term_start: Integers  # (n_in + 1,) first term of each input
    knot_start: Integers  # (n_in + 1,)
    knot: Numbers  # (n_knots,) ascending for each input
    cell_start: Integers  # (n_in,) first cell of each input
    piece_start: Integers  # (n_cells + 1,) first piece of each cell
    piece_term: Integers  # (n_pieces,) term of each piece, ascending within a cell
    piece_shape: Integers  # (n_pieces,) ``codes.LINE``, or the code of a curved shape
    piece: Numbers  # (n_pieces, 8) parameters of the code
    rejects: Integers  # (n_in,) 1 where a value outside the range is refused, 0 where it counts as the nearest end


class RuleTables(NamedTuple):
    """Rules, numbered as ``fuzzy.rules.all_rules`` numbers them, the cells of the table first."""

    norms: Integers  # (2,) codes of AND and OR
    grid: Integers  # (n_rows, n_columns) rule of each cell, -1 for none
    grid_input: Integers  # (2,) input of the rows and of the columns
    program: Integers  # (n_program,) antecedents of the listed rules in postfix order
    program_start: Integers  # (n_listed + 1,)
    weight: Numbers  # (n_listed,)
    consequent_start: Integers  # (n_rules + 1,)
    consequent_term: Integers  # (n_consequents,) output term
    consequent_output: Integers  # (n_consequents,) output of that term
    member_start: Integers  # (n_out + 1,) how many consequents the outputs before have


class OutputTables(NamedTuple):
    """Defuzzification: n_out outputs with n_terms terms, numbered through.

    Sets are the n_terms terms, followed by as many overlaps: set n_terms + k is the intersection of term k and its
    right-hand neighbour.
    """

    range: Numbers  # (n_out, 2) low, high
    term_start: Integers  # (n_out + 1,) first term of each output
    shape: Integers  # (n_terms,) membership code
    parameter: Numbers  # (n_terms, 8)
    value: Numbers  # (n_values,) coordinates of points and coefficients of functions, to which parameters refer
    peak: Numbers  # (n_terms,) the term's value for ``WEIGHTED_AVERAGE``; NaN where it depends on the inference
    implication: Integers  # (1,) code
    aggregation: Integers  # (1,) code
    grouping: Integers  # (1,) LARGEST_STRENGTH ... EVERY_CONSEQUENT
    maximum: Integers  # (1,) MEAN ... LARGEST_MAGNITUDE
    sample_start: Integers  # (n_out + 1,) first sample of each output
    sample: Numbers  # (n_samples, 2) place and weight
    method: Integers  # (n_out,) CLIPPED ... POLYGON_MAXIMA
    no_fire: Integers  # (n_out,) DEFAULT or HOLD
    no_fire_value: Numbers  # (n_out,)
    neighbour: Integers  # (n_terms,) the term to the right that overlaps this one, -1 for none
    cut_start: Integers  # (2 n_terms + 1,) first row of each set in ``cut``
    cut: Numbers  # (n_rows, 8) area and moment of a clipped set, see ``fuzzy.geometry.cut_polynomials``
    knot_start: Integers  # (n_out + 1,)
    knot: Numbers  # (n_knots,) ends of the range and all points between them where a set bends or jumps, ascending
    side_start: Integers  # (n_knots + 1,) first side of each interval that begins at a knot
    side_term: Integers  # (n_sides,) term that is not 0 there
    side: Numbers  # (n_sides, 2) its degrees just inside both ends of the interval


class Tables(NamedTuple):
    """A compiled system; all arrays are read-only."""

    inputs: InputTables
    rules: RuleTables
    outputs: OutputTables
    entries: Integers  # (n_arrays, 3) of all arrays above, see ``fuzzy.kernels.address``


class Workspace(NamedTuple):
    """What one inference writes, so that a picture shows what the controller did.

    One inference clears what the last one wrote, by the lists of what that was; the rest of the arrays is never read.

    A member of an output's aggregated set is a term with its level, see ``OutputTables.grouping``: the largest firing
    strength under max, the sum of strengths for the sum of scaled sets; where neither gives the aggregate of the rules'
    own sets, every consequent that fires is a member.
    """

    input: Numbers  # (n_in,) crisp inputs of a call without arrays
    clamped: Numbers  # (n_in,) crisp inputs within their ranges
    output: Numbers  # (n_out,) its crisp outputs, kept for the hold policy
    membership: Numbers  # (n_input_terms,) degrees of the input terms
    active: Integers  # (n_input_terms,) in each input's places its terms with a degree above 0
    active_count: Integers  # (n_in,)
    strength: Numbers  # (n_rules,) firing strengths times weights
    fired: Integers  # (n_rules,) the numbers of the rules that fired, in the first places
    fired_count: Integers  # (1,)
    height: Numbers  # (n_output_terms,) level of each output term, 0 for none
    member: Integers  # (n_consequents,) in each output's places the terms of its aggregated set
    level: Numbers  # (n_consequents,) their levels
    member_count: Integers  # (n_out,)
    gain: Numbers  # (n_out,) power of two that lifts the levels out of the reach of underflow, ordinarily 1
    undefined: Integers  # (n_out,) 1 where the no-fire policy gave the output
    stack: Numbers  # (n_stack,) operands of an antecedent
    scratch: Numbers  # (n_scratch,)


_INTEGERS = frozenset({"active", "active_count", "fired", "fired_count", "member", "member_count", "undefined"})
"""Fields of ``Workspace`` that hold integers."""


def new_workspace(tables: Tables) -> tuple[Workspace, Integers]:
    """Return a workspace for one thread that evaluates ``tables``; its outputs start with their no-fire values.

    Its arrays are parts of one block, so that there is one address to ask for.

    Returns:
        The workspace, and (n_arrays, 3) its entries in a directory, see ``fuzzy.kernels.address``.
    """
    parts, entries, length = _layout(_lengths(tables))
    block = np.zeros(length)
    whole = {False: block, True: block.view(np.int64)}
    workspace = Workspace(*(whole[is_integer][part] for part, is_integer in parts))
    workspace.output[:] = tables.outputs.no_fire_value
    workspace.gain[:] = 1.0
    entries = entries.copy()
    entries[:, 0] += block.ctypes.data
    return workspace, entries


def _lengths(tables: Tables) -> tuple[int, ...]:
    """Return the lengths of the arrays of ``Workspace``, in their order."""
    inputs, rules, outputs, _ = tables
    n_in, n_out, n_input_terms = len(inputs.range), len(outputs.range), int(inputs.term_start[-1])
    n_rules, n_consequents = rules.consequent_start.size - 1, rules.consequent_term.size
    n_terms = outputs.shape.size
    # Places where an envelope may bend within an interval, three for each pair of sets; or the lines of all members and
    # their bends; or a quadrature's account, with all points where a member may bend twice.
    n_scratch = max(3 * (n_terms + 1) ** 2, 8 * (n_consequents + 8))
    if not codes.CURVED.isdisjoint(outputs.method.tolist()):
        n_points = int(outputs.parameter[outputs.shape == codes.POINTS, 1].max(initial=0.0))
        n_bends = 2 * (n_consequents + 1) * max(codes.MOST_BENDS, 2 * n_points)
        n_scratch = max(n_scratch, 8 * (n_bends + 32))
    of_inputs = (n_in, n_in, n_out, n_input_terms, n_input_terms, n_in)
    of_outputs = (n_terms, n_consequents, n_consequents, n_out, n_out, n_out)
    return (*of_inputs, n_rules, n_rules, 1, *of_outputs, rules.program.size + 1, n_scratch)


@functools.lru_cache(maxsize=64)
def _layout(lengths: tuple[int, ...]) -> tuple[list[tuple[slice, bool]], Integers, int]:
    """Return each array's part of the block and whether it holds integers, the entries from address 0, the length."""
    ends = list(itertools.accumulate(lengths))
    begins = [0, *ends[:-1]]
    parts = [
        (slice(begin, end), name in _INTEGERS) for name, begin, end in zip(Workspace._fields, begins, ends, strict=True)
    ]
    entries = np.array([(8 * begin, length, 1) for begin, length in zip(begins, lengths, strict=True)])
    return parts, entries, ends[-1]
