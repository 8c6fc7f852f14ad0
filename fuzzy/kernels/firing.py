"""Rule evaluation: from the degrees of the input terms to firing strengths."""

from fuzzy.kernels import norms
from fuzzy.kernels import tables as codes
from fuzzy.kernels.address import tables_at, workspace_at
from fuzzy.kernels.jit import kernel

_CONJUNCTION = codes.CONJUNCTION
_DISJUNCTION = codes.DISJUNCTION


@kernel
def antecedent(address, listed):
    """Return the degree of one listed rule's antecedent, by its postfix program.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.
        listed: Number of the rule in the list, from 0.
    """
    tables = tables_at(address)
    workspace = workspace_at(address)
    membership = workspace.membership
    stack = workspace.stack
    top = -1
    for p in range(tables.program_start[listed], tables.program_start[listed + 1]):
        word = tables.program[p]
        if word >= 0:
            top += 1
            stack[top] = membership[word]
        elif word == codes.NOT:
            stack[top] = 1.0 - stack[top]
        else:
            top -= 1
            if word == codes.AND:
                stack[top] = norms.t_norm(tables.options[_CONJUNCTION], stack[top], stack[top + 1])
            else:
                stack[top] = norms.s_norm(tables.options[_DISJUNCTION], stack[top], stack[top + 1])
    return stack[0]


@kernel
def fire(address):
    """Evaluate every rule's antecedent from ``workspace.membership``.

    Of the table only the cells are visited whose row and column have a degree above 0: in a partition, four.

    Args:
        address: Of a compiled system and its workspace, see ``fuzzy.kernels.address``.

    Returns:
        How many rules fire; their numbers stand in the first places of ``workspace.fired``.

    References:
        IEC 61131-7:2000, rule evaluation; paper eq. (29).
    """
    tables = tables_at(address)
    workspace = workspace_at(address)
    membership = workspace.membership
    strength = workspace.strength
    strength[:] = 0.0
    count = 0
    rows, columns = tables.grid.shape
    first_row = tables.grid_origin[0]
    first_column = tables.grid_origin[1]
    for i in range(rows):
        row_degree = membership[first_row + i]
        if row_degree <= 0.0:
            continue
        for j in range(columns):
            column_degree = membership[first_column + j]
            rule = tables.grid[i, j]
            if column_degree > 0.0 and rule >= 0:
                degree = norms.t_norm(tables.options[_CONJUNCTION], row_degree, column_degree)
                if degree > 0.0:
                    strength[rule] = degree
                    workspace.fired[count] = rule
                    count += 1
    first_listed = strength.size - tables.weight.size
    for listed in range(tables.weight.size):
        degree = tables.weight[listed] * antecedent(address, listed)
        if degree > 0.0:
            rule = first_listed + listed
            strength[rule] = degree
            workspace.fired[count] = rule
            count += 1
    return count
