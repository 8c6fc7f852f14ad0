"""Small pieces that several panels use: callbacks that clean what they get, and pieces of HTML."""

from __future__ import annotations

import html
import logging
import math
from collections.abc import Awaitable, Callable, Sequence
from typing import Any

import viser

from app import clean
from app.clean import Refused
from app.palette import GRID, RUN, TEXT
from app.state import Event, Notice, Noticed
from app.store import Dispatch

TINY, _SMALL = 5e-4, 0.01
"""Numbers below the first read as nothing; figures between have four decimals, since three digits would be too wide."""

_LARGE = 1e6
"""Numbers from it on are written as powers of ten."""

MARK = "● "
"""Stands before the name of the button that is chosen."""

Meaning = Event | tuple[Event, ...] | None
"""What a user's change of a widget means: events, or nothing."""

_log = logging.getLogger(__name__)

FONT = "Inter,system-ui,-apple-system,'Segoe UI',sans-serif"


def on_input(handle: Any, dispatch: Dispatch, to_event: Callable[[Any], Meaning | Awaitable[Meaning]]) -> None:
    """Dispatch what a user's change of a widget means.

    A value that is refused leaves the state as it is; the rendering that follows any event puts the widget back.

    Args:
        handle: Handle of a viser input or button.
        dispatch: Where events go.
        to_event: Makes the event, or several, from the widget's value; may raise ``Refused``; None is nothing to do.
            What takes longer, such as a file, is a coroutine.
    """

    async def callback(event: viser.GuiEvent[Any]) -> None:
        if event.client is None:  # set by the program, not by a hand
            return
        try:
            meaning = to_event(event.target.value)
            meant = await meaning if isinstance(meaning, Awaitable) else meaning
        except Refused as refusal:
            meant = Noticed(Notice(f"Refused: {refusal}.", is_error=True))
        except Exception as error:
            _log.exception("what a browser sent cannot be handled")
            meant = Noticed(Notice(f"Not done, an error of the program: {error!r}.", is_error=True))
        for one in meant if isinstance(meant, tuple) else (meant,):
            if one is not None:
                dispatch(one)

    if isinstance(handle, viser.GuiButtonHandle | viser.GuiButtonGroupHandle):
        handle.on_click(callback)
    else:
        handle.on_update(callback)


class ChoiceGroup:
    """A row of buttons of which one is chosen, which viser's own button group cannot show.

    Args:
        gui: Where it is added.
        label: Stands to the left.
        dispatch: Where events go.
        to_event: Makes the event from the name that was pressed.
    """

    def __init__(
        self, gui: viser.GuiApi, label: str, dispatch: Dispatch, to_event: Callable[[str], Event | None]
    ) -> None:
        self._handle: Any = gui.add_button_group(label, ("–",))
        self._names: tuple[str, ...] = ()
        on_input(self._handle, dispatch, lambda option: to_event(self._name(option)))

    def show(self, names: Sequence[str], chosen: str) -> None:
        """Show these names, ``chosen`` marked."""
        self._names = tuple(names)
        options = tuple(f"{MARK}{name}" if name == chosen else name for name in names)
        put(self._handle, options=options)

    def set_visible(self, is_visible: bool) -> None:
        """Show or hide the row."""
        put(self._handle, visible=is_visible)

    def _name(self, option: object) -> str:
        text = option.removeprefix(MARK) if isinstance(option, str) else option
        return clean.choice(text, self._names)


def put(handle: Any, **properties: object) -> None:
    """Set the properties of a handle that are others than now; viser takes 30 µs to see that one is the same."""
    for name, value in properties.items():
        if getattr(handle, name) != value:
            setattr(handle, name, value)


def element_id(handle: Any) -> str:
    """Return the id of a handle's element in the page.

    The one private name of viser's that the panels rely on; a browser test fails when it moves.
    """
    return handle._impl.uuid


def full_width_html(handle: Any, left: int, right: int) -> str:
    """Return a style sheet that takes away an input's label and sets its distance in pixels from the panel's edges."""
    label = f'label[for="{element_id(handle)}"]'
    column = f"div:has(> p > {label})"
    return f"<style>{column}{{display:none}}{column} + div{{margin:0 {right}px 0 {left}px}}</style>"


def aligned_html(handles: Sequence[Any]) -> str:
    """Return a style sheet that gives inputs in a folder without a name the labels' width of those outside."""
    columns = ",".join(f'div:has(> p > label[for="{element_id(handle)}"])' for handle in handles)
    return f"<style>{columns}{{width:7.25em !important}}</style>"


def div(content: str, style: str = "") -> str:
    """Return a block in the workbench's type, as wide as the other widgets of a panel."""
    base = f"padding:0 0.75em;margin:0.35em 0;font:13px/1.45 {FONT};color:{TEXT};overflow-wrap:anywhere"
    return f'<div style="{base};{style}">{content}</div>'


def progress_bar(share: float, text: str) -> str:
    """Return a bar that is full at a share of 1, with the percentage and a text below."""
    bar = f'<div style="width:{100.0 * share:.0f}%;height:8px;border-radius:4px;background:{RUN}"></div>'
    return div(f'<div style="background:{GRID};border-radius:4px">{bar}</div>{100.0 * share:.0f} % {text}')


def escape(text: str) -> str:
    """Return text as HTML that shows it: names come from files and browsers."""
    return html.escape(text, quote=True)


def number(value: float, digits: int = 3) -> str:
    """Return a number for reading, in ``digits`` significant digits, with a real minus sign; tiny ones as "≈ 0".

    Digits before the point are all written, up to a million.
    """
    if 0.0 < abs(value) < TINY:
        return "≈ 0"
    text = f"{value:.{digits}g}"
    if "e" in text and abs(value) < _LARGE:
        text = f"{value:.0f}"
    return text.replace("-", "−")


def figure(value: float) -> str:
    """Return a figure of merit for a table: a dash where it is not defined, "never" where it is infinite."""
    if math.isnan(value):
        return "–"
    if math.isinf(value):
        return "never"
    return f"{value:.4f}" if TINY < value < _SMALL else number(value)


def equation(name: str, value: float) -> str:
    """Return "name = value" for reading; of a tiny value "name ≈ 0"."""
    text = number(value)
    return f"{name} {text}" if text.startswith("≈") else f"{name} = {text}"


def coordinate_label(name: str) -> str:
    """Return a coordinate's name for reading: ``theta1`` is θ1."""
    return name.replace("theta", "θ")
