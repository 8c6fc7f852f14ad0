"""What a designer does to a system: pure functions FuzzySystem -> FuzzySystem.

Each returns a valid system or raises :class:`InvalidSystemError`; the system that was given stays as it is.
"""

from fuzzy.edits.document import set_inference, set_name, set_notes
from fuzzy.edits.grids import (
    Grid,
    default_grid,
    fitting_grid,
    give_table,
    grid_cells,
    grid_rule_numbers,
    is_table,
    set_grid_cells,
)
from fuzzy.edits.rule_list import add_rule, remove_rule, set_rule, set_weight
from fuzzy.edits.spacing import fresh_name, insert_term, space_terms
from fuzzy.edits.symmetry import follow_in_mirror
from fuzzy.edits.tables import (
    clear_table,
    dissolve_table,
    fill_diagonal,
    fill_linear,
    fill_piltan,
    full_gains,
    mirror_antisymmetrically,
    rule_table,
    set_cell,
    set_cells,
)
from fuzzy.edits.terms import (
    MoveMode,
    add_term,
    move_point,
    move_term,
    remove_term,
    rename_term,
    set_shape,
    set_shape_kind,
)
from fuzzy.edits.variables import rename_variable, set_no_fire, set_out_of_range, set_range, set_unit

__all__ = [
    "Grid",
    "MoveMode",
    "add_rule",
    "add_term",
    "clear_table",
    "default_grid",
    "dissolve_table",
    "fill_diagonal",
    "fill_linear",
    "fill_piltan",
    "fitting_grid",
    "follow_in_mirror",
    "fresh_name",
    "full_gains",
    "give_table",
    "grid_cells",
    "grid_rule_numbers",
    "insert_term",
    "is_table",
    "mirror_antisymmetrically",
    "move_point",
    "move_term",
    "remove_rule",
    "remove_term",
    "rename_term",
    "rename_variable",
    "rule_table",
    "set_cell",
    "set_cells",
    "set_grid_cells",
    "set_inference",
    "set_name",
    "set_no_fire",
    "set_notes",
    "set_out_of_range",
    "set_range",
    "set_rule",
    "set_shape",
    "set_shape_kind",
    "set_unit",
    "set_weight",
    "space_terms",
]
