"""One output over one or two inputs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from fuzzy.analysis.places import Numbers, Place, check_count, number_of, place_of
from fuzzy.errors import InvalidInputError
from fuzzy.inference import Controller
from fuzzy.system import Input

MAX_POINTS = 2001
"""Greatest number of points along one axis of a surface or a section."""


class Surface(NamedTuple):
    """Control surface: one output over two inputs.

    Attributes:
        x_name: Input along the columns.
        y_name: Input along the rows.
        output: Name of the output.
        x: (nx,) values of the first input over its range, in its unit.
        y: (ny,) values of the second input.
        value: (ny, nx) crisp output, in its unit; NaN where it is undefined.
        at: Where the other inputs are held.
    """

    x_name: str
    y_name: str
    output: str
    x: Numbers
    y: Numbers
    value: Numbers
    at: Mapping[str, float]


class Section(NamedTuple):
    """One output along one input.

    Attributes:
        along: Name of the input.
        output: Name of the output.
        x: (n,) values of the input over its range, in its unit.
        value: (n,) crisp output, in its unit; NaN where it is undefined.
        at: Where the other inputs are held.
    """

    along: str
    output: str
    x: Numbers
    value: Numbers
    at: Mapping[str, float]


def surface(
    controller: Controller,
    x_name: str | None = None,
    y_name: str | None = None,
    points: tuple[int, int] = (41, 41),
    at: Place | None = None,
    output: str | None = None,
) -> Surface:
    """Return one output over the ranges of two inputs.

    Args:
        controller: The compiled system.
        x_name: Input along the columns; the first by default.
        y_name: Input along the rows; the first other one by default.
        points: nx, ny, from 2 to ``MAX_POINTS``.
        at: Where the other inputs are held; mid-range by default.
        output: Name of the output; the first by default.

    Raises:
        InvalidInputError: Unknown or repeated names, fewer than two inputs, ``points`` or ``at`` that cannot be used.
    """
    inputs = controller.system.inputs
    if len(inputs) < 2:
        raise InvalidInputError("a surface needs two inputs; valid for this system: section")
    names = [variable.name for variable in inputs]
    first = number_of(x_name, inputs, "input") if x_name is not None else int(y_name == names[0])
    second = number_of(y_name, inputs, "input") if y_name is not None else int(first == 0)
    if first == second:
        others = [name for name in names if name != names[first]]
        raise InvalidInputError(f"a surface over '{names[first]}' twice; valid beside it: {', '.join(others)}")
    if not isinstance(points, Sequence) or len(points) != 2:
        raise InvalidInputError(f"points {points!r}; valid: two numbers, nx and ny")
    x, y = (_axis(inputs[n], count) for n, count in zip((first, second), points, strict=True))
    place = place_of(controller.system, at)
    number = number_of(output, controller.system.outputs, "output")
    rows = np.tile(place, (x.size * y.size, 1))
    rows[:, first] = np.tile(x, y.size)
    rows[:, second] = np.repeat(y, x.size)
    value = controller.batch(rows)[:, number].reshape(y.size, x.size)
    held = {name: float(place[n]) for n, name in enumerate(names) if n not in (first, second)}
    return Surface(names[first], names[second], controller.system.outputs[number].name, x, y, value, held)


def section(
    controller: Controller,
    along: str | None = None,
    at: Place | None = None,
    points: int = 201,
    output: str | None = None,
) -> Section:
    """Return one output along the range of one input.

    Args:
        controller: The compiled system.
        along: Name of the input; the first by default.
        at: Where the other inputs are held; mid-range by default.
        points: How many, from 2 to ``MAX_POINTS``.
        output: Name of the output; the first by default.

    Raises:
        InvalidInputError: Unknown names, ``points`` or ``at`` that cannot be used.
    """
    system = controller.system
    chosen = number_of(along, system.inputs, "input")
    number = number_of(output, system.outputs, "output")
    x = _axis(system.inputs[chosen], points)
    place = place_of(system, at)
    rows = np.tile(place, (x.size, 1))
    rows[:, chosen] = x
    held = {variable.name: float(place[n]) for n, variable in enumerate(system.inputs) if n != chosen}
    return Section(
        system.inputs[chosen].name, system.outputs[number].name, x, controller.batch(rows)[:, number].copy(), held
    )


def _axis(variable: Input, points: int) -> Numbers:
    check_count(points, MAX_POINTS)
    return np.linspace(variable.low, variable.high, points)
