"""What a designer does to a system: pure functions FuzzySystem -> FuzzySystem.

Each returns a valid system or raises :class:`InvalidSystemError`; the system that was given stays as it is.
"""

from fuzzy.edits.document import set_inference, set_name, set_notes
from fuzzy.edits.tables import (
    clear_table,
    fill_diagonal,
    fill_piltan,
    mirror_antisymmetrically,
    rule_table,
    set_cell,
    set_cells,
)
from fuzzy.edits.terms import (
    MoveMode,
    add_term,
    move_point,
    remove_term,
    rename_term,
    set_shape,
    set_shape_kind,
)
from fuzzy.edits.variables import rename_variable, set_no_fire, set_out_of_range, set_range

__all__ = [
    "MoveMode",
    "add_term",
    "clear_table",
    "fill_diagonal",
    "fill_piltan",
    "mirror_antisymmetrically",
    "move_point",
    "remove_term",
    "rename_term",
    "rename_variable",
    "rule_table",
    "set_cell",
    "set_cells",
    "set_inference",
    "set_name",
    "set_no_fire",
    "set_notes",
    "set_out_of_range",
    "set_range",
    "set_shape",
    "set_shape_kind",
]
