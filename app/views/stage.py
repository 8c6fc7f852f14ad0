"""Run: what the scene shows, and from where; the camera belongs to each browser, the layers to all."""

from __future__ import annotations

from typing import Any

import viser

from app import clean
from app.clean import Refused
from app.scene.cameras import CAMERAS, look
from app.state import LAYERS, AppState, Notice, Noticed, Selected
from app.store import Shown, Store
from app.widgets import MARK, div, on_input, put


class StageView:
    """Buttons for cameras and layers."""

    def __init__(self, gui: viser.GuiApi, store: Store) -> None:
        self._store = store
        camera = gui.add_button_group("camera", tuple(CAMERAS))
        camera.on_click(self._look)
        self._layers: Any = gui.add_button_group("layers", LAYERS)
        on_input(self._layers, store.dispatch, self._toggle)
        gui.add_html(div("Shift and drag on the arm pulls it; a click on a tile paints it.", "opacity:.6"))

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are shown."""
        return (state.hidden,)

    def render(self, state: AppState) -> None:
        """Mark the layers that are shown."""
        options = tuple(name if name in state.hidden else f"{MARK}{name}" for name in LAYERS)
        put(self._layers, options=options)

    def _toggle(self, value: object) -> Selected:
        text = value.removeprefix(MARK) if isinstance(value, str) else value
        name = clean.choice(text, LAYERS, "the layer")
        return Selected({"hidden": self._store.state.hidden ^ {name}})

    async def _look(self, event: viser.GuiEvent[Any]) -> None:
        if event.client is None:
            return
        try:
            look(event.client, clean.choice(event.target.value, CAMERAS, "the camera"))
        except Refused as refusal:
            self._store.dispatch(Noticed(Notice(f"Refused: {refusal}.", is_error=True)))
