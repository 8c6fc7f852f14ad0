"""FuzzySystem -> Tables: every name becomes an index, and all that an inference can know beforehand is computed.

The inputs' tables depend on the inputs alone, the outputs' on the outputs and the operators; they are kept, so that
painting a cell compiles the rules and nothing else.
"""

from __future__ import annotations

import numpy as np

from fuzzy.compiler.inputs import compile_inputs
from fuzzy.compiler.outputs import compile_outputs
from fuzzy.compiler.rules import CONSEQUENTS, compile_rules
from fuzzy.kernels.tables import Tables
from fuzzy.system import FuzzySystem


def compile_tables(system: FuzzySystem) -> Tables:
    """Compile a valid system.

    Args:
        system: A system that has passed :func:`fuzzy.validation.validate`.

    Returns:
        Read-only tables.

    Raises:
        InvalidSystemError: When a rule names a variable or a term that is not there.
    """
    inputs, input_entries = compile_inputs(system.inputs)
    outputs, output_entries = compile_outputs(system.outputs, system.inference)
    rule_tables, rule_entries = compile_rules(system)
    listed = np.concatenate((input_entries, rule_entries, output_entries))
    listed[len(input_entries) + CONSEQUENTS, 0] = rule_tables.consequent_term.ctypes.data
    listed.setflags(write=False)
    return Tables(inputs, rule_tables, outputs, listed)
