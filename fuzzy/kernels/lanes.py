"""Many inferences side by side: one step of all of them, then the next, so that the processor's vector units work.

A single inference looks up the few terms and rules that are active. Side by side it is quicker to compute every rule
for all of them: the same operations on neighbouring numbers, without a branch. The formulas, and the order of every
sum, are those of a single inference, and so are the results, bit for bit.

This is for the systems that are designed most: AND over input terms, and outputs by ``codes.CLIPPED``. The rows of
others, and rows that are special (not finite, refused, no rule fires), are evaluated one after another.
"""

import math

from fuzzy.kernels import codes, exact, inference, membership, norms
from fuzzy.kernels.address import at, inputs_at, outputs_at, rules_at
from fuzzy.kernels.defuzzify import TINY
from fuzzy.kernels.jit import borrowing_kernel

LANES = 128
"""Rows side by side: enough that a step's overhead is small, few enough that all their numbers stay in the cache."""

_ROWS = 7
"""Rows of a block beside the terms."""


def block_shape(n_input_terms: int, n_output_terms: int) -> tuple[int, int]:
    """Return the shape of the memory that ``evaluate_rows`` needs for a system with so many terms."""
    return n_input_terms + n_output_terms + _ROWS, LANES


@borrowing_kernel
def evaluate_rows(address, x, y, first, end, block):
    """Run independent inferences.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        x: (n, n_in) crisp inputs, one inference a row.
        y: (n, n_out) in: the last outputs of every row, for the hold policy; out: crisp outputs.
        first: First row to evaluate.
        end: The row after the last one.
        block: Memory of ``block_shape``; its contents do not matter.

    Returns:
        A row of which an input is not finite or is rejected, -1 for none.
    """
    refused = -1
    row = first
    if _suits(address):
        n_terms = block.shape[0] - _ROWS
        while row + LANES <= end:
            usual = block[at(n_terms)]
            _fuzzify(address, x, row, block, usual, block[at(n_terms + 1)], block[at(n_terms + 2)])
            _fire(address, block, block[at(n_terms + 1)])
            _defuzzify(address, y, row, block, usual, block[n_terms + 1 :])
            for lane in range(LANES):
                if usual[lane] == 0.0 and inference.evaluate(address, x[at(row + lane)], y[at(row + lane)]) < 0:
                    refused = row + lane
            row += LANES
    return max(refused, inference.evaluate_rows(address, x, y, row, end))


@borrowing_kernel
def _suits(address):
    """Return whether the system is one that is evaluated side by side."""
    rules = rules_at(address)
    for method in outputs_at(address).method:
        if method != codes.CLIPPED:
            return False
    joined = 0
    for end in rules.program_start[1:]:
        joined += int(rules.program[end - 1] == codes.ALL)
    return joined == rules.weight.size


@borrowing_kernel
def _fuzzify(address, x, row, block, usual, value, cell):
    """Write the degrees of all input terms into the first rows of ``block``, and 1 into ``usual`` for usual inputs."""
    inputs = inputs_at(address)
    usual[:] = 1.0
    for i in range(inputs.cell_start.size):
        low = inputs.range[at(i), 0]
        high = inputs.range[at(i), 1]
        rejects = inputs.rejects[at(i)] == 1
        for lane in range(LANES):
            given = x[at(row + lane), at(i)]
            value[lane] = min(max(given, low), high)
            if not abs(given) < math.inf or (rejects and value[lane] != given):
                usual[lane] = 0.0
                value[lane] = low
        cell[:] = inputs.cell_start[at(i)]
        for knot in inputs.knot[at(inputs.knot_start[at(i)]) : at(inputs.knot_start[at(i + 1)])]:
            for lane in range(LANES):
                cell[lane] += float(int(knot < value[lane]) + int(knot <= value[lane]))
        for k in range(inputs.term_start[at(i)], inputs.term_start[at(i + 1)]):
            block[at(k)] = 0.0
        for lane in range(LANES):
            c = int(cell[lane])
            for n in range(inputs.piece_start[at(c)], inputs.piece_start[at(c + 1)]):
                degree = membership.degree(inputs.piece_shape[at(n)], inputs.piece[at(n)], inputs.knot, value[lane])
                block[at(inputs.piece_term[at(n)]), at(lane)] = degree if degree > 0.0 else 0.0


@borrowing_kernel
def _fire(address, block, degree):
    """Write the level of every output term, its largest firing strength, behind the input terms of ``block``."""
    inputs = inputs_at(address)
    rules = rules_at(address)
    code = rules.norms[0]
    n_inputs = inputs.term_start[at(inputs.cell_start.size)]
    for k in range(outputs_at(address).shape.size):
        block[at(n_inputs + k)] = 0.0
    if rules.grid.size > 0:
        first_row = inputs.term_start[at(rules.grid_input[0])]
        first_column = inputs.term_start[at(rules.grid_input[1])]
        for r in range(rules.grid.shape[0]):
            row = block[at(first_row + r)]
            for c in range(rules.grid.shape[1]):
                column = block[at(first_column + c)]
                rule = rules.grid[at(r), at(c)]
                if rule >= 0:
                    level = block[at(n_inputs + rules.consequent_term[at(rules.consequent_start[at(rule)])])]
                    for lane in range(LANES):
                        level[lane] = max(level[lane], norms.t_norm(code, row[lane], column[lane]))
    first_listed = rules.consequent_start.size - 1 - rules.weight.size
    for listed in range(rules.weight.size):
        start = rules.program_start[at(listed)]
        only = block[at(rules.program[at(start)])]
        for lane in range(LANES):
            degree[lane] = only[lane]
        for p in range(start + 1, rules.program_start[at(listed + 1)] - 1):
            following = block[at(rules.program[at(p)])]
            for lane in range(LANES):
                degree[lane] = norms.t_norm(code, degree[lane], following[lane])
        weight = rules.weight[at(listed)]
        rule = first_listed + listed
        for c in range(rules.consequent_start[at(rule)], rules.consequent_start[at(rule + 1)]):
            level = block[at(n_inputs + rules.consequent_term[at(c)])]
            for lane in range(LANES):
                level[lane] = max(level[lane], weight * degree[lane])


@borrowing_kernel
def _defuzzify(address, y, row, block, usual, spare):
    """Write the crisp outputs of the usual lanes, see ``exact.clipped_centroid``; others are usual no longer."""
    outputs = outputs_at(address)
    levels = block[inputs_at(address).term_start[at(inputs_at(address).cell_start.size)] :]
    n_terms = outputs.shape.size
    common, largest, area, moment = spare[0], spare[1], spare[2], spare[3]
    for output in range(outputs.method.size):
        largest[:] = 0.0
        area[:] = 0.0
        moment[:] = 0.0
        for k in range(outputs.term_start[at(output)], outputs.term_start[at(output + 1)]):
            level = levels[at(k)]
            for lane in range(LANES):
                largest[lane] = max(largest[lane], level[lane])
            _add_clipped(address, k, level, 1.0, area, moment, spare[4:])
            right = outputs.neighbour[at(k)]
            if right >= 0:
                other = levels[at(right)]
                for lane in range(LANES):
                    common[lane] = min(level[lane], other[lane])
                _add_clipped(address, n_terms + k, common, -1.0, area, moment, spare[4:])
        low = outputs.range[at(output), 0]
        high = outputs.range[at(output), 1]
        middle = 0.5 * (low + high)
        for lane in range(LANES):
            if not (largest[lane] >= TINY and area[lane] > 0.0):
                usual[lane] = 0.0
        for lane in range(LANES):
            if usual[lane] != 0.0:
                y[at(row + lane), at(output)] = min(max(middle + moment[lane] / area[lane], low), high)


@borrowing_kernel
def _add_clipped(address, index, height, sign, area, moment, spare):
    """Add area and moment of a set clipped at the lanes' heights; the index is that of ``OutputTables.cut_start``."""
    outputs = outputs_at(address)
    part, part_moment = spare[0], spare[1]
    first = outputs.cut_start[at(index)]
    for row in range(first, outputs.cut_start[at(index + 1)]):
        found = outputs.cut[at(row)]
        # Numbers that cannot change while the loops write, as those of an array might.
        cut = (found[0], found[1], found[2], found[3], found[4], found[5], found[6], found[7])
        if row == first:
            for lane in range(LANES):
                part[lane], part_moment[lane] = exact.cut_below(cut, height[lane])
        else:
            for lane in range(LANES):
                below, below_moment = exact.cut_below(cut, height[lane])
                is_above = not cut[0] > height[lane]
                part[lane] = below if is_above else part[lane]
                part_moment[lane] = below_moment if is_above else part_moment[lane]
    for lane in range(LANES):
        area[lane] += sign * part[lane]
        moment[lane] += sign * part_moment[lane]
