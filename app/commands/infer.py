"""``infer``: a table of inputs through a controller."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import tyro

if TYPE_CHECKING:
    from fuzzy.system import Sampling


def infer(
    file: tyro.conf.Positional[Annotated[Path, tyro.conf.arg(metavar="FILE")]],
    /,
    *,
    inputs: Annotated[Path, tyro.conf.arg(metavar="IN.csv")],
    output: Annotated[Path, tyro.conf.arg(metavar="OUT.csv")],
    resolution: Annotated[str | None, tyro.conf.arg(metavar="exact|N", help_behavior_hint="")] = None,
) -> int:
    """Compute the outputs for every row of a CSV file.

    The first line of IN.csv names the inputs, in any order; every further one holds one number for each. OUT.csv gets
    one column for each output, with 17 digits, and nan where the output is undefined.

    Args:
        file: The rule base, in any format; - reads standard input.
        inputs: CSV file with the inputs; - reads standard input.
        output: CSV file for the outputs, written whole or not at all; - writes standard output.
        resolution: Defuzzify in closed form (exact) or over N interval midpoints; by default as the rule base says.
    """
    import msgspec
    import numpy as np

    from app.commands.failure import failure
    from app.commands.files import read_columns, write_columns
    from app.commands.rulebases import load, refuse_two_from_standard_input
    from fuzzy.inference import compile_system

    refuse_two_from_standard_input(file, inputs)
    system = load(file)
    if resolution is not None:
        operators = msgspec.structs.replace(system.inference, resolution=_resolution(resolution))
        system = msgspec.structs.replace(system, inference=operators)
    controller = compile_system(system)
    table = read_columns(inputs, [variable.name for variable in system.inputs])
    for place, variable in enumerate(system.inputs):
        outside = (table.values[:, place] < variable.low) | (table.values[:, place] > variable.high)
        if variable.out_of_range == "reject" and outside.any():
            row = int(np.argmax(outside))
            valid = f"valid: {variable.low:g} to {variable.high:g}"
            raise failure(f"{variable.name} is {table.values[row, place]:g}; {valid}", inputs, int(table.lines[row]), 1)
    write_columns(output, [variable.name for variable in system.outputs], controller.batch(table.values))
    return 0


def _resolution(text: str) -> Literal["exact"] | Sampling:
    from app.commands.failure import UsageError
    from fuzzy.errors import shown
    from fuzzy.limits import MAX_POINTS, MIN_POINTS
    from fuzzy.system import Sampling

    if text == "exact":
        return "exact"
    if len(text) < 10 and text.isdecimal() and text.isascii() and MIN_POINTS <= int(text) <= MAX_POINTS:
        return Sampling(int(text))
    raise UsageError(
        f"resolution '{shown(text)}'; valid: exact, or a number of points from {MIN_POINTS} to {MAX_POINTS}"
    )
