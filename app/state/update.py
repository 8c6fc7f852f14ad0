"""The pure function that takes the state from one event to the next."""

from __future__ import annotations

from typing import assert_never

import msgspec

from app.state import kept, study
from app.state.design import after_edit, fitting, names_of, without_drafts
from app.state.events import (
    Advised,
    Asked,
    Begun,
    DesignChanged,
    Edit,
    Event,
    Imported,
    JumpedTo,
    KeptRemoved,
    KeptRenamed,
    Noticed,
    Opened,
    PlaybackChanged,
    Progressed,
    Recovered,
    Redo,
    ResetRequested,
    RunFinished,
    RunKept,
    Saved,
    Selected,
    SetupChanged,
    SurfaceFound,
    Undo,
    Uploaded,
)
from app.state.model import AppState, Notice, Source, Step, Work
from app.state.setup import changed
from app.state.study import (
    FitChosen,
    FitOrdered,
    StudyCancelled,
    StudyChosen,
    StudyFinished,
    StudyOrdered,
    StudyProgressed,
)
from app.storage import Stamp
from fuzzy import edits
from fuzzy.errors import FuzzyError
from fuzzy.system import FuzzySystem

HISTORY_LENGTH = 200
"""Steps that can be undone."""

GESTURE_SECONDS = 2.0
"""Edits of one gesture that follow each other faster are undone together."""


_replace = msgspec.structs.replace

_TERM = {"variable", "term"}


def initial(
    document: FuzzySystem, *, file: str | None = None, stamp: Stamp | None = None, files: tuple[str, ...] = ()
) -> AppState:
    """Return the state in which the workbench opens with a document."""
    grid = edits.default_grid(document)
    output = next((variable for variable in document.outputs if grid and variable.name == grid.output), None)
    brush = output.terms[-1].name if output else None
    state = AppState(document=document, source=Source(document, file, stamp), files=files, brush=brush)
    return _with_valid_selection(state)


def update(state: AppState, event: Event) -> AppState:  # noqa: C901
    """Return the state after an event. Pure: no clock, no files, no widgets; a refused edit leaves a notice."""
    match event:
        case Edit():
            return _edited(state, event)
        case Undo():
            return _undone(state)
        case Redo():
            return _redone(state)
        case JumpedTo():
            return _jumped(state, event.steps)
        case Opened():
            step = Step(state.document, f"open {event.file}", source=state.source)
            opened = _changed(state, event.document, (*state.past, step), ())
            source = Source(event.document, event.file, event.stamp)
            return _replace(opened, source=source, files=event.files, notice=None, question=None)
        case Uploaded():
            return _replace(state, upload=event.upload, notice=None)
        case Imported():
            return _imported(state)
        case Begun():
            return _taken(state, event.document, f"new {event.document.name}", new_name="")
        case Saved():
            return _saved(state, event)
        case Recovered():
            return _recovered(state, event.work)
        case Asked():
            return _replace(state, question=event.question)
        case Selected():
            # What is being written belongs to the term and variable that were chosen.
            named = {"design": without_drafts(state.design)} if event.changes.keys() & _TERM else {}
            return _with_valid_selection(_replace(state, **(named | event.changes)))
        case DesignChanged():
            return _with_valid_selection(_replace(state, design=_replace(state.design, **event.changes)))
        case SetupChanged():
            setup = changed(state.setup, event.changes)
            # The run before belongs to another experiment: nothing to compare with.
            return _replace(state, setup=setup, runs=_replace(state.runs, before=None), notice=None)
        case PlaybackChanged():
            return _replace(state, playback=_replace(state.playback, **event.changes))
        case ResetRequested():
            playback = state.playback
            return _replace(state, playback=_replace(playback, time=0.0, resets=playback.resets + 1))
        case RunKept():
            return kept.keep(state)
        case KeptRenamed():
            return kept.rename(state, event.slot, event.name)
        case KeptRemoved():
            return kept.remove(state, event.slot)
        case RunFinished():
            if event.setup != state.setup:
                return state
            runs = _replace(state.runs, current=event.result, pid=event.pid, advice=None)
            return _replace(state, runs=runs, findings=event.findings)
        case SurfaceFound():
            return _replace(state, runs=_replace(state.runs, landscape=event.landscape))
        case Advised():
            if event.result is not state.runs.current:
                return state
            return _replace(state, runs=_replace(state.runs, advice=event.advice))
        case Progressed():
            return _replace(state, progress=event.text)
        case Noticed():
            return _replace(state, notice=event.notice)
        case (
            StudyChosen()
            | StudyOrdered()
            | FitChosen()
            | FitOrdered()
            | StudyCancelled()
            | StudyProgressed()
            | StudyFinished()
        ):
            changed_study = study.after(state.study, event, state.document, state.setup)
            return state if changed_study is state.study else _replace(state, study=changed_study)
        case _:
            assert_never(event)


def _saved(state: AppState, event: Saved) -> AppState:
    source = Source(event.document, event.file, event.stamp)
    notice = Notice(f"Saved {event.file}.")
    saved = _replace(state, files=event.files, notice=notice, question=None)
    if event.origin is None or event.origin == state.source:
        return _replace(saved, source=source)

    def after(step: Step) -> Step:  # the document that was saved waits in the history
        return _replace(step, source=source) if step.source == event.origin else step

    return _replace(saved, past=tuple(map(after, state.past)), future=tuple(map(after, state.future)))


def _recovered(state: AppState, work: Work) -> AppState:
    """Return the state with recovered work; edits made since the start come between it and its own history."""
    past = work.past
    if state.past:
        way_back = Step(work.document, "recovered work", source=work.source)
        past = (*past, way_back, *state.past, Step(state.document, "recover", source=state.source))
    changed = _changed(state, work.document, past, work.future)
    # A crash may come between saving and the journal: a file that holds one of these documents is no one else's.
    own = (work.document, *(step.document for step in (*work.past, *work.future)))
    is_own = state.file == work.source.file and state.source.saved in own
    source = state.source if is_own else work.source
    return _replace(changed, source=source, notice=Notice("Recovered the unsaved work."), question=None)


def _edited(state: AppState, event: Edit) -> AppState:
    try:
        document = event.change(state.document)
    except FuzzyError as error:
        return _replace(state, notice=Notice(f"Not done: {error}.", is_error=True))
    if document == state.document:
        return _replace(state, notice=None)
    last = state.past[-1] if state.past else None
    if last and event.gesture and last.gesture == event.gesture and event.at - last.at < GESTURE_SECONDS:
        past = (*state.past[:-1], _replace(last, label=event.label, at=event.at))
        design = after_edit(state.design)
        merged = _replace(state, document=document, past=past, future=(), notice=None, design=design)
        return _with_valid_selection(merged)
    step = Step(state.document, event.label, event.gesture, event.at)
    return _replace(_changed(state, document, (*state.past, step), ()), notice=None)


def _undone(state: AppState) -> AppState:
    if not state.past:
        return _replace(state, notice=Notice("Nothing to undo."))
    step = state.past[-1]
    future = (_opposite(state, step), *state.future)
    undone = _changed(state, step.document, state.past[:-1], future)
    return _replace(undone, source=step.source or state.source, notice=Notice(f"Undone: {step.label}."))


def _redone(state: AppState) -> AppState:
    if not state.future:
        return _replace(state, notice=Notice("Nothing to redo."))
    step = state.future[0]
    past = (*state.past, _opposite(state, step))
    redone = _changed(state, step.document, past, state.future[1:])
    return _replace(redone, source=step.source or state.source, notice=Notice(f"Done again: {step.label}."))


def _imported(state: AppState) -> AppState:
    """Return the state with the uploaded document; its name is proposed for the file that it has not yet."""
    upload = state.upload
    if upload is None:
        return state
    return _taken(state, upload.document, f"import {upload.name}", new_name=upload.name.rpartition(".")[0])


def _taken(state: AppState, document: FuzzySystem, label: str, new_name: str) -> AppState:
    """Return the state with a document that is in no file yet."""
    step = Step(state.document, label, source=state.source)
    changed = _changed(state, document, (*state.past, step), ())
    return _replace(changed, source=Source(None), upload=None, new_name=new_name, notice=None)


def _jumped(state: AppState, steps: int) -> AppState:
    """Return the state some steps back, or forth."""
    if not -len(state.past) <= steps <= len(state.future):
        return _replace(state, notice=Notice("That step of the history is no longer there.", is_error=True))
    for _ in range(abs(steps)):
        state = _undone(state) if steps < 0 else _redone(state)
    words = "back" if steps < 0 else "again"
    count = f"{abs(steps)} step{'s' if abs(steps) != 1 else ''}"
    return _replace(state, notice=Notice(f"{count} {words}.")) if steps else state


def _opposite(state: AppState, step: Step) -> Step:
    """Return the step that leads back from where ``step`` leads."""
    return Step(state.document, step.label, source=state.source if step.source else None)


def _changed(state: AppState, document: FuzzySystem, past: tuple[Step, ...], future: tuple[Step, ...]) -> AppState:
    """Return the state with another document; the run so far becomes the one to compare with."""
    runs = _replace(state.runs, before=state.runs.current)
    design = after_edit(state.design)
    if names_of(document) != names_of(state.document):  # another system: its own grid says more than one that fits
        design = _replace(design, grid=None)
    kept = past[-HISTORY_LENGTH:]
    changed = _replace(state, document=document, past=kept, future=future, runs=runs, design=design)
    return _with_valid_selection(changed)


def _with_valid_selection(state: AppState) -> AppState:
    """Return the state with selections that exist in the document, the nearest where one is gone."""
    document = state.document
    variables = {variable.name: variable for variable in (*document.inputs, *document.outputs)}
    variable = state.variable if state.variable in variables else document.inputs[0].name
    terms = [term.name for term in variables[variable].terms]
    term = state.term if state.term in terms else terms[len(terms) // 2]
    design = fitting(state.design, document)
    # Without a grid there is nothing to paint: the brush waits for the next document with one.
    brushes = [t.name for t in variables[design.grid.output].terms] if design.grid else [state.brush]
    brush = state.brush if state.brush is None or state.brush in brushes else brushes[-1]
    if (variable, term, brush, design) == (state.variable, state.term, state.brush, state.design):
        return state
    return _replace(state, variable=variable, term=term, brush=brush, design=design)
