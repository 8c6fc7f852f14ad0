"""Number fields side by side, and what a browser sends for them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import viser

from app import clean
from app.store import Dispatch
from app.widgets import Meaning, on_input, put

MOST_VALUE = 1e12
"""Greatest magnitude of a number that may be typed."""


class NumberRow:
    """Up to three number fields in a row; viser has a widget for one, for two and for three.

    Args:
        gui: Where it is added.
        dispatch: Where events go.
        to_event: Makes the event from the numbers, as many as are shown.
    """

    def __init__(self, gui: viser.GuiApi, dispatch: Dispatch, to_event: Callable[[tuple[float, ...]], Meaning]) -> None:
        step = 0.001
        self._handles: dict[int, Any] = {
            1: gui.add_number("–", 0.0, step=step, visible=False),
            2: gui.add_vector2("–", (0.0, 0.0), step=step, visible=False),
            3: gui.add_vector3("–", (0.0, 0.0, 0.0), step=step, visible=False),
        }
        for handle in self._handles.values():
            on_input(handle, dispatch, lambda value: to_event(_cleaned(value)))

    def show(self, shown: Sequence[tuple[str, float]], decimals: int) -> None:
        """Show these names and numbers, at most three; none hides the row."""
        for size, handle in self._handles.items():
            put(handle, visible=size == len(shown))
            if handle.visible:
                label = " · ".join(name for name, _ in shown)
                put(handle, label=label, precision=decimals, step=10.0**-decimals)
                values = tuple(float(value) for _, value in shown)
                handle.value = values[0] if size == 1 else values


def _cleaned(value: object) -> tuple[float, ...]:
    values = value if isinstance(value, tuple) else (value,)
    return tuple(clean.number(one, -MOST_VALUE, MOST_VALUE, "the parameter") for one in values)
