"""Which rules to look at when an output should have been smaller or greater for a while."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from fuzzy import edits
from fuzzy.analysis.contributions import shares
from fuzzy.inference import Controller
from fuzzy.rules import table_rule_indices
from fuzzy.system import FuzzySystem


def culprits(controller: Controller, x: ArrayLike, direction: int, most: int = 4) -> tuple[tuple[int, float], ...]:
    """Return the rules that moved the first output most while it should have gone the other way.

    First those that pushed on, the strongest first, then those that braked: they could have braked more.

    Args:
        controller: The compiled system.
        x: (n, n_in) the inputs of that time.
        direction: 1 if the output was too large, -1 if too small.
        most: How many rules.

    Returns:
        Numbers of rules, as in ``fuzzy.rules.all_rules``, each with its mean push in ``direction``, in the output's
        unit; negative for one that braked.

    Raises:
        InvalidInputError: Inputs that ``Controller.batch`` refuses.
    """
    rows = np.asarray(x, dtype=np.float64)
    push = shares(controller, rows, np.full(len(rows), direction / max(len(rows), 1))).moved
    order = [int(n) for n in np.argsort(-push) if push[n] > 0.0]
    brakes = [int(n) for n in np.argsort(push) if push[n] < 0.0]
    chosen = [*order[: max(most - 2, most - len(brakes))], *brakes][:most]
    return tuple((n, float(push[n])) for n in chosen)


def stepped(system: FuzzySystem, number: int, steps: int) -> tuple[FuzzySystem, str] | None:
    """Return a system whose rule concludes another term of the output, and that term; None where there is none.

    Args:
        system: The document.
        number: Of a rule in the table; rules of the list stay as they are.
        steps: 1 is the next term, -1 the one before.
    """
    table = system.rules.table
    if table is None:
        return None
    for i, row in enumerate(table_rule_indices(system)):
        if number in row:
            j = row.index(number)
            terms = [term.name for output in system.outputs if output.name == table.output for term in output.terms]
            place = terms.index(table.cells[i][j] or "") + steps
            if not 0 <= place < len(terms):
                return None
            return edits.set_cell(system, row=i, column=j, consequent=terms[place]), terms[place]
    return None
