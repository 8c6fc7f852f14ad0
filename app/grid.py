"""Clickable HTML for the rule table: labels that press hidden viser buttons.

Viser's own buttons are too large for a table of 7 × 7, and its HTML element reports no clicks. A ``<label for=...>``
presses a real button, wherever it stands; the buttons themselves are hidden visually only, so that Tab, Enter and
Space still reach them. The table's HTML stays as it is while the arm moves; what glows is a separate style sheet,
since an element that is replaced between press and release loses the click.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import viser

from app.palette import GRID, MARK, MUTED, RGB, SURFACE, TEXT, css, ink, term_colors
from app.widgets import FONT, element_id, escape
from fuzzy import partition
from fuzzy.system import Output

GAP = 4
"""Pixels between cells."""

BASE_STYLE = (
    f"<style>.fw,.fw-h{{text-align:center;overflow:hidden;white-space:nowrap;text-overflow:ellipsis;min-width:0}}"
    f".fw{{height:32px;padding:0 2px;border-radius:5px;font:600 12px/30px {FONT};"
    f"cursor:pointer;user-select:none;box-sizing:border-box}}"
    f".fw:hover{{filter:brightness(1.12)}}.fw-s{{height:24px;line-height:22px}}"
    f".fw-h{{font:500 12px {FONT};line-height:32px;color:{MUTED}}}"
    f".fw-r{{display:block;padding:2px 6px;border-radius:4px;background:{SURFACE};color:{TEXT};cursor:pointer;"
    f"font:12px/1.4 {FONT};overflow-wrap:anywhere}}.fw-r:hover{{filter:brightness(1.2)}}</style>"
)
"""How cells, headings and rows look."""

_IN_LINE = 9
"""Brushes that stand in one line; more stand in several, one fewer in each."""
_BRUSH_HEIGHT = 206
"""Pixels that the brushes may take; the rest is reached by scrolling."""

PAGE = 8
"""Rows of a list that are shown at once."""

_MOST_LABELED, _LABELS_A_BUTTON = 72, 6
"""Labels that are changed in one turn of the event loop, and how many of them take as long as a new button."""


class HiddenButtons:
    """Real viser buttons that labels elsewhere in the page press, reached by the keyboard too.

    Args:
        gui: Where they are added; in the present container.
        labels: What screen readers say, one a button.
        on_press: Called with the number of the button that was pressed, on the event loop.

    Attributes:
        ids: Of the buttons' elements in the page.
    """

    def __init__(self, gui: viser.GuiApi, labels: Sequence[str], on_press: Callable[[int], None]) -> None:
        self._gui = gui
        self._on_press = on_press
        self._folder = gui.add_folder(None)
        with self._folder:
            self._style = gui.add_html("")
        self._buttons: list[viser.GuiButtonHandle] = []
        self.ids: list[str] = []
        while self.relabel(labels):
            pass

    def relabel(self, labels: Sequence[str]) -> bool:
        """Give the buttons other labels, and add or remove some at the end until there are as many.

        Returns:
            Whether some are still to be done, by another call: viser takes 0.2 ms for a button, 0.03 ms for a label.
        """
        left = _MOST_LABELED
        for button, label in zip(self._buttons, labels, strict=False):
            if button.label != label:
                if not left:
                    return True
                button.label = label
                left -= 1
        for button in self._buttons[len(labels) :]:
            button.remove()
        kept = self._buttons[: len(labels)]
        with self._folder:
            added = [self._gui.add_button(label) for label in labels[len(kept) :][: left // _LABELS_A_BUTTON]]
        for number, button in enumerate(added, len(kept)):
            button.on_click(_presser(self._on_press, number))
        self._buttons = [*kept, *added]
        self.ids = [element_id(button) for button in self._buttons]
        selector = ",".join(f'[id="{name}"]' for name in self.ids)
        hidden = "position:fixed;width:1px;height:1px;overflow:hidden;opacity:0;pointer-events:none"
        self._style.content = f"<style>div:has(> :is({selector})){{{hidden}}}</style>"
        return len(self._buttons) < len(labels)


def _presser(on_press: Callable[[int], None], number: int) -> Callable[[viser.GuiEvent[Any]], Any]:
    async def press(_: viser.GuiEvent[Any]) -> None:
        on_press(number)

    return press


def cell_style(color: RGB | None) -> str:
    """Return the CSS of a cell in the colour of its output term; None is a cell without a rule."""
    if color is None:
        return f"background:transparent;border:1px dashed {GRID};color:{MUTED}"
    return f"background:{css(color)};border:1px solid transparent;color:{ink(color)}"


def brush_html(output: Output, ids: Sequence[str]) -> str:
    """Return the brushes: all output terms from the least value to the greatest, then "none".

    Args:
        output: The output that the table concludes.
        ids: Of the hidden buttons, in the order of the terms; the last is that of "none".
    """
    count = len(output.terms)
    names = [*(term.name for term in output.terms), "none"]
    colors = [*term_colors(output), None]
    places = partition.places(output)
    is_one_line = count < _IN_LINE
    cells = []
    for number in (*sorted(range(count), key=places.__getitem__), count):
        name = escape(names[number])
        title = f"{name} at {places[number]:.4g} {escape(output.unit)}" if number < count else "no rule"
        cells.append(
            f'<label for="{ids[number]}" id="brush{number}" class="fw{"" if is_one_line else " fw-s"}" title="{title}" '
            f'style="{cell_style(colors[number])}">{name}</label>'
        )
    if is_one_line:
        return _grid(cells, f"repeat({len(cells)},minmax(0,1fr))")
    return _grid(cells, f"repeat({_IN_LINE - 1},minmax(0,1fr))", f"max-height:{_BRUSH_HEIGHT}px;overflow-y:auto")


def chosen_brush_html(number: int) -> str:
    """Return the style sheet that frames the chosen brush; apart, since brushes that are replaced would scroll back."""
    return f"<style>#brush{number}{{outline:2px solid #fff;outline-offset:1px}}</style>"


def table_html(
    rows: tuple[str, Sequence[str]],
    columns: tuple[str, Sequence[str]],
    cells: Sequence[Sequence[str | None]],
    colors: Mapping[str, RGB],
    ids: Sequence[str],
) -> str:
    """Return the rule table.

    Args:
        rows: Name of the rows' variable and of its terms.
        columns: Likewise for the columns.
        cells: Consequent of each cell, None for no rule.
        colors: Of all output terms.
        ids: Of the hidden buttons, row by row.
    """
    header = [_heading(f"{rows[0]} \\ {columns[0]}")]
    header += [_heading(name) for name in columns[1]]
    body = list(header)
    width = len(columns[1])
    for i, row in enumerate(cells):
        body.append(_heading(rows[1][i]))
        for j, name in enumerate(row):
            color = None if name is None else colors[name]
            title = f"{rows[0]} is {rows[1][i]} and {columns[0]} is {columns[1][j]}"
            body.append(
                f'<label for="{ids[i * width + j]}" id="cell{i}-{j}" class="fw" title="{escape(title)}" '
                f'style="{cell_style(color)}">{escape(name or "·")}</label>'
            )
    return _grid(body, f"minmax(2.6em,0.8fr) repeat({width},minmax(0,1fr))")


def _heading(text: str) -> str:
    return f'<span class="fw-h" title="{escape(text)}">{escape(text)}</span>'


def focus_html(ids: Sequence[str], width: int) -> str:
    """Return the rules by which the keyboard's focus shows on the cells of the buttons ``ids``."""
    focus = (
        f'body:has([id="{name}"]:focus-visible) #cell{number // width}-{number % width}'
        "{outline:2px solid #fff;outline-offset:1px}"
        for number, name in enumerate(ids)
    )
    return f"<style>{''.join(focus)}</style>"


def row_html(target: str, name: str, content: str) -> str:
    """Return a row of a list that presses the button ``target``; ``content`` is HTML."""
    return f'<label for="{target}" id="{name}" class="fw-r">{content}</label>'


def rows_html(rows: Sequence[str], height: int | None = None) -> str:
    """Return rows below each other, in at most so many pixels: beyond that they scroll."""
    scrolls = "" if height is None else f"max-height:{height}px;overflow-y:auto;"
    style = f"{scrolls}margin:0 0.75em 0.35em;padding:2px;display:grid;gap:3px"
    return f'<div style="{style}">{"".join(rows)}</div>' if rows else ""


def chosen_html(name: str) -> str:
    """Return the style sheet that frames the chosen row; apart, since rows that are replaced would scroll back."""
    return f"<style>#{name}{{outline:1.5px solid {TEXT}}}</style>"


def row_glow_html(strengths: Sequence[float], first: int) -> str:
    """Return the style sheet that fills the rows of the rules from number ``first`` on by their firing strengths."""
    lines = (
        f"#rule{first + n}{{background:linear-gradient(90deg,rgba(79,143,247,.38) {100 * strength:.0f}%,{SURFACE} 0)}}"
        for n, strength in enumerate(strengths)
        if strength > 0.0
    )
    return f"<style>{''.join(lines)}</style>"


def glow_html(
    strengths: Sequence[Sequence[float]],
    silent: Sequence[Sequence[bool]],
    marked: Sequence[tuple[int, int]] = (),
) -> str:
    """Return the style sheet that lets the cells glow.

    Args:
        strengths: Firing strength of each cell now, in [0, 1].
        silent: Whether a cell with a rule never fired in the whole run: these are hatched.
        marked: Row and column of cells that are framed.
    """
    lines = [f"#cell{i}-{j}{{outline:2.5px solid {MARK};outline-offset:1px}}" for i, j in marked]
    for i, row in enumerate(strengths):
        for j, strength in enumerate(row):
            if strength > 0.0:
                blur = 3 + 9 * strength
                alpha = 0.35 + 0.65 * strength
                lines.append(
                    f"#cell{i}-{j}{{box-shadow:inset 0 0 0 {1.5 + 1.5 * strength:.1f}px rgba(255,255,255,{alpha:.2f}),"
                    f"0 0 {blur:.0f}px rgba(255,255,255,{0.75 * strength:.2f})}}"
                )
            elif silent[i][j]:
                lines.append(
                    f"#cell{i}-{j}{{background-image:repeating-linear-gradient(135deg,transparent 0 5px,"
                    "rgba(16,18,24,.32) 5px 7px)!important}"
                )
    return f"<style>{''.join(lines)}</style>"


def _grid(cells: Sequence[str], template: str, style: str = "") -> str:
    style = f"display:grid;grid-template-columns:{template};gap:{GAP}px;padding:0.35em 0.75em;{style}"
    return f'<div style="{style}">{"".join(cells)}</div>'
