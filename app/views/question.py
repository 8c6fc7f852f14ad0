"""What only the user can decide: whose version of a file stays, and what a crashed session left."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, assert_never

import viser

from app.filing import Filing
from app.journal import Journal
from app.state import AppState, Asked, Conflict, Question, Recovered, Recovery
from app.store import Dispatch, Shown
from app.widgets import Meaning, div, escape, on_input

_OVERWRITE = "Save mine over it"
_RELOAD = "Open theirs"
_SAVE_AS = "Save mine as"
_RECOVER = "Recover it"
_DISCARD = "Discard it"
_LATER = "Decide later"


class QuestionView:
    """A window over the page for the question that waits, if there is one.

    Args:
        gui: Where it is shown.
        dispatch: Where events go.
        filing: Saves and opens what was decided.
        journal: Forgets what was recovered or is not wanted.
    """

    def __init__(self, gui: viser.GuiApi, dispatch: Dispatch, filing: Filing, journal: Journal) -> None:
        self._gui = gui
        self._dispatch = dispatch
        self._filing = filing
        self._journal = journal
        self._asked: Question | None = None
        self._window: Any = None

    def shows(self, state: AppState) -> Shown:
        """Return the parts that are shown."""
        return (state.question,)

    def render(self, state: AppState) -> None:
        """Open or close the window."""
        if state.question == self._asked:
            return
        if self._window is not None:
            self._window.close()
            self._window = None
        self._asked = question = state.question
        match question:
            case None:
                pass
            case Conflict():
                self._ask_whose(question, _free_name(question.file, state.files))
            case Recovery():
                self._ask_to_recover(question)
            case _:
                assert_never(question)

    def _ask_whose(self, conflict: Conflict, other: str) -> None:
        name = escape(conflict.file)
        text = (
            f"<b>{name}</b> was changed by somebody else since it was opened here. Saving yours over it keeps theirs "
            f"as {name}.bak; after opening theirs, Ctrl+Z brings yours back."
        )
        with self._open("The file has changed on disk"):
            self._gui.add_html(div(text))
            self._button(_OVERWRITE, lambda: self._filing.save_as(conflict.file, overwrite=True))
            self._button(_RELOAD, lambda: self._filing.open(conflict.file))
            self._button(f"{_SAVE_AS} {other}", lambda: self._filing.save_as(other))
            self._button(_LATER, lambda: Asked(None))

    def _ask_to_recover(self, recovery: Recovery) -> None:
        work = recovery.work
        when = time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(recovery.at))
        text = (
            f"A session that ended at {when} left unsaved edits of <b>{escape(work.source.file or 'no file')}</b>: "
            f"{len(work.past)} steps can be undone, {len(work.future)} done again. The file is as it was last saved."
        )
        with self._open("Unsaved work was found"):
            self._gui.add_html(div(text))
            self._button(_RECOVER, lambda: self._recovered(recovery))
            self._button(_DISCARD, lambda: self._discarded(recovery))
            self._button(_LATER, lambda: Asked(None))

    def _open(self, title: str) -> Any:
        self._window = self._gui.add_modal(title)
        return self._window

    def _button(self, label: str, answer: Callable[[], Any]) -> None:
        on_input(self._gui.add_button(label), self._dispatch, lambda _: answer())

    def _recovered(self, recovery: Recovery) -> Meaning:
        self._journal.forget(recovery.journal)
        return Recovered(recovery.work)

    def _discarded(self, recovery: Recovery) -> Meaning:
        self._journal.discard(recovery.journal)
        return Asked(None)


def _free_name(file: str, taken: tuple[str, ...]) -> str:
    """Return a name for the user's own version that no file has."""
    stem = file.rpartition(".")[0]
    names = (f"{stem}-mine{number}.yaml" for number in ("", *range(2, len(taken) + 3)))
    return next(name for name in names if name not in taken)
