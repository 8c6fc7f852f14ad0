"""Rule evaluation: from the degrees of the input terms to firing strengths."""

from fuzzy.kernels import codes, hedges, norms
from fuzzy.kernels.address import at, inputs_at, outputs_at, rules_at, workspace_at
from fuzzy.kernels.jit import borrowing_kernel


@borrowing_kernel
def antecedent(address, listed, fired):
    """Return the degree of one listed rule's antecedent, by its postfix program.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        listed: Number of the rule in the list, from 0.
        fired: How many of the rules before it fire.
    """
    rules = rules_at(address)
    workspace = workspace_at(address)
    stack = workspace.stack
    first = rules.program_start[at(listed)]
    last = rules.program_start[at(listed + 1)] - 1
    if rules.program[at(last)] == codes.ALL:
        degree = workspace.membership[at(rules.program[at(first)])]
        for p in range(first + 1, last):
            if degree == 0.0:
                break
            degree = norms.t_norm(rules.norms[0], degree, workspace.membership[at(rules.program[at(p)])])
        return degree
    top = -1
    for p in range(first, last + 1):
        word = rules.program[p]
        if word >= workspace.membership.size:
            top += 1
            stack[top] = activation(address, word - workspace.membership.size, fired)
        elif word >= 0:
            top += 1
            stack[top] = workspace.membership[word]
        elif word == codes.NOT:
            stack[top] = 1.0 - stack[top]
        elif word <= codes.HEDGE:
            stack[top] = hedges.hedge(codes.HEDGE - word, stack[top])
        else:
            top -= 1
            if word == codes.AND:
                stack[top] = norms.t_norm(rules.norms[0], stack[top], stack[top + 1])
            else:
                stack[top] = norms.s_norm(rules.norms[1], stack[top], stack[top + 1])
    return stack[0]


@borrowing_kernel
def activation(address, term, fired):
    """Return how far an output term is activated by the rules that have fired: their strengths, aggregated.

    Args:
        address: Of a compiled system and its workspace.
        term: Number of the output term.
        fired: How many rules have fired; their numbers stand in the first places of ``workspace.fired``.

    References:
        fuzzylite 6, output variables in antecedents.
    """
    rules = rules_at(address)
    workspace = workspace_at(address)
    code = outputs_at(address).aggregation[0]
    total = 0.0
    for n in range(fired):
        rule = workspace.fired[n]
        for c in range(rules.consequent_start[rule], rules.consequent_start[rule + 1]):
            if rules.consequent_term[c] == term:
                strength = workspace.strength[rule]
                total = max(total, strength) if code == norms.LEAST else norms.aggregation(code, total, strength)
    return min(total, 1.0)


@borrowing_kernel
def fire(address):
    """Evaluate every rule's antecedent from ``workspace.membership``.

    Of the table only the cells are visited whose row and column are active: in a partition, four.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.

    Returns:
        How many rules fire; their numbers stand in the first places of ``workspace.fired``.

    References:
        IEC 61131-7:2000, rule evaluation; paper eq. (29).
    """
    rules = rules_at(address)
    workspace = workspace_at(address)
    membership = workspace.membership
    strength = workspace.strength
    fired = workspace.fired
    for n in range(workspace.fired_count[0]):
        strength[at(fired[at(n)])] = 0.0
    count = 0
    if rules.grid.size > 0:
        inputs = inputs_at(address)
        row_input = rules.grid_input[0]
        column_input = rules.grid_input[1]
        first_row = inputs.term_start[at(row_input)]
        first_column = inputs.term_start[at(column_input)]
        rows = workspace.active_count[at(row_input)]
        columns = workspace.active_count[at(column_input)]
        for r in range(first_row, first_row + rows):
            row = workspace.active[at(r)]
            for c in range(first_column, first_column + columns):
                column = workspace.active[at(c)]
                rule = rules.grid[at(row - first_row), at(column - first_column)]
                degree = norms.t_norm(rules.norms[0], membership[at(row)], membership[at(column)])
                if rule >= 0 and degree > 0.0:
                    strength[at(rule)] = degree
                    fired[at(count)] = rule
                    count += 1
    first_listed = strength.size - rules.weight.size
    for listed in range(rules.weight.size):
        degree = rules.weight[at(listed)] * antecedent(address, listed, count)
        if degree > 0.0:
            strength[at(first_listed + listed)] = degree
            fired[at(count)] = first_listed + listed
            count += 1
    workspace.fired_count[0] = count
    return count
