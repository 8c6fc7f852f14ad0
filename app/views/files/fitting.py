"""Design › Files › Sugeno approximation: fitted to the present system, ordered, cancelled and opened here."""

from __future__ import annotations

import viser

from app.palette import BAD, MUTED
from app.state import AppState, Begun
from app.state.study import FitChosen, FitOrdered, Fitted, Method, StudyCancelled
from app.store import Shown, Store
from app.widgets import ChoiceGroup, div, escape, number, on_input, progress_bar, put

_METHODS: dict[str, Method] = {
    "least squares": "least squares",
    "minimax": "least greatest error",
    "own sets": "Gaussians of their own",
}
"""Names of the buttons."""


class FittingView:
    """Chooses how, starts and cancels a fit, shows its errors and opens what was fitted."""

    def __init__(self, gui: viser.GuiApi, store: Store) -> None:
        self._store = store
        text = "A Sugeno system, a value for each combination of the inputs' terms, that does nearly the same."
        gui.add_html(div(f"<b>Sugeno approximation</b><br>{text}", f"color:{MUTED}"))
        self._methods = ChoiceGroup(gui, "fit by", store.dispatch, lambda name: FitChosen(_METHODS[name]))
        self._start = gui.add_button("Fit", hint="least squares; minimax: least greatest error; own sets: 12 Gaussians")
        self._cancel = gui.add_button("Cancel the fit", visible=False, color="orange")
        self._bar = gui.add_html("")
        self._open = gui.add_button("Open the approximation", visible=False, hint="Ctrl+Z brings the present one back")
        on_input(self._start, store.dispatch, lambda _: FitOrdered())
        on_input(self._cancel, store.dispatch, lambda _: StudyCancelled())
        on_input(self._open, store.dispatch, self._opened)

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are shown."""
        return state.study, state.document

    def render(self, state: AppState) -> None:
        """Show how far a fit is, and what the last one found."""
        study = state.study
        is_running = study.order is not None and study.order.method is not None
        button = next(name for name, method in _METHODS.items() if method == study.method)
        self._methods.show(list(_METHODS), button)
        put(self._start, visible=not is_running)
        put(self._cancel, visible=is_running)
        put(self._open, visible=not is_running and study.fitted is not None)
        if is_running:
            content = progress_bar(study.done, "of the steps at most; it may end sooner")
        else:
            content = "" if study.fitted is None else _fitted_html(study.fitted, state)
        put(self._bar, content=content)

    def _opened(self, _: object) -> Begun | None:
        fitted = self._store.state.study.fitted
        return None if fitted is None else Begun(fitted.document)


def _fitted_html(fitted: Fitted, state: AppState) -> str:
    output = fitted.document.outputs[0]
    unit = f" {escape(output.unit)}" if output.unit else ""
    share = 100 * fitted.largest / (output.high - output.low)
    count = len(fitted.document.rules.list)
    stale = f'<div style="color:{BAD}">▲ fitted before the last change: fit again</div>'
    return div(
        f"{'' if state.document in (fitted.order.document, fitted.document) else stale}"
        f"{escape(fitted.order.document.name)} by {fitted.order.method}: {count} rules, RMS error "
        f"{number(fitted.rms)}{unit}, greatest {number(fitted.largest)}{unit} ({share:.2g} % of the range)"
    )
