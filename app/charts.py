"""uPlot charts in the workbench's look."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import viser
from numpy.typing import NDArray
from viser import uplot

from app.palette import GRID, MUTED

_X_AXIS = 30
"""Pixels for the numbers under a chart; uPlot's own 50 leave a gap."""

Array = NDArray[np.float64]


class Line(NamedTuple):
    """How a curve looks: its name in the legend, colour, width in pixels, dashes, fill, and whether it is seen."""

    label: str
    color: str
    width: float = 2.0
    dash: tuple[int, int] | None = None
    fill: str | None = None
    is_shown: bool = True


def add_chart(
    gui: viser.GuiApi,
    lines: Sequence[Line],
    *,
    height: int,
    x_label: str = "t",
    y_range: tuple[float, float] | None = None,
    has_legend: bool = True,
    data: tuple[Array, ...] | None = None,
) -> viser.GuiUplotHandle:
    """Add a chart of curves over a common x.

    Args:
        gui: Where it is added.
        lines: One for each curve.
        height: In pixels.
        x_label: Name of x in the legend.
        y_range: Fixed range of y; None for that of the data.
        has_legend: Whether names and values of the curves stand below.
        data: x and one array a curve; empty at first by default.
    """
    scales: dict[str, uplot.Scale] = {"x": uplot.Scale(time=False)}
    if y_range is not None:
        scales["y"] = uplot.Scale(range=y_range, auto=False)
    x_axis = uplot.Axis(stroke=MUTED, grid=uplot.Axis_Grid(stroke=GRID, width=1), ticks=uplot.Axis_Ticks(stroke=GRID))
    y_axis: uplot.Axis = {**x_axis, "space": 28}
    x_axis["size"] = _X_AXIS
    return gui.add_uplot(
        data=data or tuple(np.array([0.0, 1.0]) for _ in range(len(lines) + 1)),
        series=series(lines, x_label),
        scales=scales,
        axes=(x_axis, y_axis),
        height=height,
        legend=None if has_legend else uplot.Legend(show=False),
        padding=(8, 14, 0, 0),
    )


def series(lines: Sequence[Line], x_label: str = "t") -> tuple[uplot.Series, ...]:
    """Return the series of a chart: x, then one for each line."""
    described = [uplot.Series(label=x_label)]
    for line in lines:
        one = uplot.Series(
            label=line.label, stroke=line.color, width=line.width, points=uplot.Series_Points(show=False)
        )
        if not line.is_shown:
            one["show"] = False
        if line.dash is not None:
            one["dash"] = line.dash
        if line.fill is not None:
            one["fill"] = line.fill
        described.append(one)
    return tuple(described)


def resampled(x: Array, x_given: Array, y: Array) -> Array:
    """Return ``y`` at the places ``x``, its last value beyond its end: a NaN would spoil uPlot's axes."""
    return np.interp(x, x_given, y) if len(x_given) else np.zeros(len(x))
