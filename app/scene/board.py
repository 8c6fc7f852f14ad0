"""The rule board: a tile for every cell of the rule table, as high as its rule fires, painted by a click."""

from __future__ import annotations

from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from app.painting import grid_variables, painted, shown_grid
from app.palette import RGB, linear, term_colors
from app.runner import Frame
from app.scene.stage import BOARD, SIDE, label_text, shares_to_floor
from app.state import AppState
from app.store import Shown, Store
from app.widgets import put
from fuzzy import edits
from fuzzy.system import Variable

_GAP = 0.10
"""Share of a tile's place that stays free."""
_LOW, _HIGH = 0.010, 0.060
"""Height of a tile that does not fire and of one that fires fully, m: low, so that none hides another."""
_EMPTY: RGB = (52, 55, 62)
_MOST_LABELS = 9
"""Terms along one side that still have a name each."""
_MOST_LETTERS = 8
"""Length of a term's name: the next one stands beside it."""
_LABEL_DISTANCE = 0.025

_CUBE = np.array([[x, y, z] for z in (0, 1) for y in (-0.5, 0.5) for x in (-0.5, 0.5)], dtype=np.float32)
_FACES = np.array(
    [[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4], [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6],
     [1, 3, 5], [3, 7, 5]],
    dtype=np.uint32,
)  # fmt: skip


class _Side:
    """The names along a side of the board, which stay when their number changes: a new label costs as much as six.

    Args:
        scene: Where they are added.
        node: Name of their place in the scene.
        is_column: Whether the terms of the columns are named, from left to right; otherwise those of the rows.
    """

    def __init__(self, scene: viser.SceneApi, node: str, *, is_column: bool) -> None:
        self._scene = scene
        self._node = node
        self._is_column = is_column
        self._labels: list[Any] = []
        self._shown: tuple[str, ...] = ()

    def name(self, variable: Variable) -> None:
        """Show the terms' names, unless they are too many, and the variable's beyond their end."""
        names = _names(variable)
        if len(names) > _MOST_LABELS:
            names = ()
        texts = (label_text(variable.name), *(label_text(name, _MOST_LETTERS) for name in names))
        before, self._shown = self._shown, texts
        if self._shown == before:
            return
        if len(self._shown) != len(before):
            self._place(len(names))
        for label, text in zip(self._labels, texts, strict=False):
            put(label, text=text)

    def set_visible(self, is_visible: bool) -> None:
        """Show or hide the names."""
        for number, label in enumerate(self._labels):
            put(label, visible=is_visible and number < len(self._shown))

    def _place(self, count: int) -> None:
        """Put the variable's label beyond the end and ``count`` others beside their tiles."""
        margin = -_LABEL_DISTANCE / SIDE
        along = [1.0 - 1.4 * margin, *((k + 0.5) / count for k in range(count))]
        shares = np.array([(margin, share) if self._is_column else (share, margin) for share in along])
        for number, (x, y) in enumerate(shares_to_floor(shares, BOARD).tolist()):
            if number < len(self._labels):
                self._labels[number].position = (x, y, BOARD[2])
                continue
            label = self._scene.add_label(
                f"{self._node}/{number}", "", position=(x, y, BOARD[2]), anchor="center-center",
                font_screen_scale=0.75 if number else 0.95,
            )  # fmt: skip
            self._labels.append(label)


class BoardView:
    """Tiles and their names; the tiles are made anew only for another number of them."""

    def __init__(self, scene: viser.SceneApi, store: Store) -> None:
        self._scene = scene
        self._store = store
        self._size = (0, 0)
        self._tiles: Any = None
        self._sides = (_Side(scene, "/board/row", is_column=False), _Side(scene, "/board/column", is_column=True))
        self._numbers = np.empty(0, dtype=np.int64)
        self._colors = np.empty((0, 3))
        self._strengths = np.empty(0)

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are shown."""
        return state.document, state.design.grid, state.hidden

    def render(self, state: AppState) -> None:
        """Colour the tiles by what their rules conclude."""
        shown = shown_grid(state)
        if shown is None or "board" in state.hidden:
            self._set_visible(False)
            return
        rows, columns, output = grid_variables(state.document, shown)
        size = (len(rows.terms), len(columns.terms))
        is_new = size != self._size
        if is_new:
            self._size = size
            self._build(*size)
        for side, variable in zip(self._sides, (rows, columns), strict=True):
            side.name(variable)
        self._set_visible(True)
        of_terms = dict(zip(_names(output), term_colors(output), strict=True))
        cells = [cell for row in edits.grid_cells(state.document, shown) for cell in row]
        colors = [_EMPTY if cell is None else of_terms[cell] for cell in cells]
        numbers = np.array(edits.grid_rule_numbers(state.document, shown)).ravel()
        if not is_new and np.array_equal(colors, self._colors) and np.array_equal(numbers, self._numbers):
            return
        self._colors, self._numbers = np.array(colors, dtype=np.float64), numbers
        self._strengths = np.zeros(len(cells))
        self._draw()

    def show(self, frame: Frame) -> None:
        """Raise the tiles with the firing strengths of the chosen coordinate."""
        numbers = self._numbers
        if self._tiles is None or not self._tiles.visible:
            return
        strengths = np.zeros(len(numbers))
        if frame.strength is not None and frame.strength.size > max(numbers.max(initial=-1), 0):
            strengths = np.where(numbers >= 0, frame.strength[numbers], 0.0).round(2)
        if not np.array_equal(strengths, self._strengths):
            self._strengths = strengths
            self._draw()

    def _draw(self) -> None:
        scales: NDArray[np.float32] = self._tiles.batched_scales.copy()
        scales[:, 2] = _LOW + (_HIGH - _LOW) * self._strengths
        glow = 0.45 * self._strengths[:, np.newaxis]
        self._tiles.batched_scales = scales
        self._tiles.batched_colors = linear(self._colors + (255.0 - self._colors) * glow)

    def _build(self, n: int, m: int) -> None:
        """Put n rows of m tiles in the place of those that are there."""
        if self._tiles is not None:
            self._tiles.remove()
        i, j = np.divmod(np.arange(n * m), m)
        floor = shares_to_floor(np.stack([(i + 0.5) / n, (j + 0.5) / m], axis=1), BOARD)
        positions = np.concatenate([floor, np.full((n * m, 1), BOARD[2])], axis=1)
        size = (1.0 - _GAP) * SIDE
        scales = np.tile(np.array([size / m, size / n, _LOW], dtype=np.float32), (n * m, 1))
        upright = np.tile([1.0, 0.0, 0.0, 0.0], (n * m, 1))
        self._tiles = self._scene.add_batched_meshes_simple(
            "/board/tiles", _CUBE, _FACES, upright, positions, batched_scales=scales,
            batched_colors=np.full((n * m, 3), _EMPTY, dtype=np.uint8), flat_shading=True, lod="off",
            cast_shadow=False, receive_shadow=False,
        )  # fmt: skip
        self._tiles.on_click(self._clicked)

    def _set_visible(self, is_visible: bool) -> None:
        if self._tiles is not None:
            put(self._tiles, visible=is_visible)
        for side in self._sides:
            side.set_visible(is_visible)

    async def _clicked(self, event: viser.SceneNodePointerEvent[Any]) -> None:
        state, number = self._store.state, event.instance_index
        edit = None if number is None else painted(state, number)
        if edit is not None:
            self._store.dispatch(edit)


def _names(variable: Variable) -> tuple[str, ...]:
    return tuple(term.name for term in variable.terms)
