"""The pure state: what is undone comes back exactly, what is refused changes nothing, selections always exist."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple, cast

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app import state as app_state
from app.state import (
    GESTURE_SECONDS,
    HISTORY_LENGTH,
    Advised,
    AppState,
    Asked,
    Begun,
    Conflict,
    Design,
    DesignChanged,
    Edit,
    Event,
    Imported,
    JumpedTo,
    KeptRemoved,
    KeptRenamed,
    Notice,
    Noticed,
    Opened,
    PlaybackChanged,
    Progressed,
    Recovered,
    Redo,
    ResetRequested,
    Result,
    RunFinished,
    RunKept,
    Saved,
    Selected,
    Setup,
    SetupChanged,
    SurfaceFound,
    Undo,
    Upload,
    Uploaded,
    Work,
    initial,
    update,
)
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
from fuzzy.formats import dumps, load
from fuzzy.shapes import Triangle, parameter_names
from fuzzy.system import FuzzySystem, Is, Variable
from tests import strategies

RULEBASES = Path(__file__).parents[2] / "rulebases"
DIAGONAL = load(RULEBASES / "diagonal.yaml")
PILTAN = load(RULEBASES / "piltan.yaml")
STAMP = Stamp(1, 2, "3")


def result(name: str) -> Result:
    """A simulated run as the state sees it: something with an identity."""
    return Result(cast("Any", f"run {name}"), cast("Any", f"metrics {name}"), cast("Any", f"rows of {name}"))


def variables(system: FuzzySystem) -> tuple[Variable, ...]:
    return (*system.inputs, *system.outputs)


def paint(row: int, column: int, term: str | None) -> Edit:
    return Edit("paint", partial(edits.set_cell, row=row, column=column, consequent=term))


def move(value: float, gesture: str = "drag", at: float = 0.0) -> Edit:
    change = partial(edits.move_point, variable="e", term="PS", parameter="b", value=value)
    return Edit(f"move to {value:g}", change, gesture, at)


def after(state: AppState, *events: Event) -> AppState:
    for event in events:
        state = update(state, event)
    return state


# Any edits of any system. Some are refused: every one asks for something without looking whether it can be had.


class Pick(NamedTuple):
    """Numbers with which an edit chooses what it changes, of whatever the document holds by then."""

    variable: int
    term: int
    other: int
    share: float
    name: str


def _variable(system: FuzzySystem, pick: Pick) -> Variable:
    return variables(system)[pick.variable % len(variables(system))]


def _move(system: FuzzySystem, pick: Pick) -> FuzzySystem:
    variable = _variable(system, pick)
    term = variable.terms[pick.term % len(variable.terms)]
    names = parameter_names(term.shape)
    value = variable.low + pick.share * (variable.high - variable.low)
    mode = "free" if pick.other % 2 else "partition"
    return edits.move_point(system, variable.name, term.name, names[pick.other % len(names)], value, mode)


def _paint(system: FuzzySystem, pick: Pick) -> FuzzySystem:
    names = [None, pick.name, *(term.name for term in system.outputs[0].terms)]
    return edits.set_cell(system, pick.term, pick.other, names[pick.variable % len(names)])


def _rename_term(system: FuzzySystem, pick: Pick) -> FuzzySystem:
    variable = _variable(system, pick)
    return edits.rename_term(system, variable.name, variable.terms[pick.term % len(variable.terms)].name, pick.name)


def _remove_term(system: FuzzySystem, pick: Pick) -> FuzzySystem:
    variable = _variable(system, pick)
    return edits.remove_term(system, variable.name, variable.terms[pick.term % len(variable.terms)].name)


def _add_term(system: FuzzySystem, pick: Pick) -> FuzzySystem:
    variable = _variable(system, pick)
    shape = Triangle(variable.low, variable.low + pick.share * (variable.high - variable.low), variable.high)
    return edits.add_term(system, variable.name, pick.name, shape, pick.term)


def _rename_variable(system: FuzzySystem, pick: Pick) -> FuzzySystem:
    return edits.rename_variable(system, _variable(system, pick).name, pick.name)


def _set_range(system: FuzzySystem, pick: Pick) -> FuzzySystem:
    variable = _variable(system, pick)
    high = variable.low + pick.share * 2 * (variable.high - variable.low)
    return edits.set_range(system, variable.name, variable.low, high, scales_terms=bool(pick.other % 2))


def _set_shape(system: FuzzySystem, pick: Pick) -> FuzzySystem:
    variable = _variable(system, pick)
    kind = ("triangle", "trapezoid", "gaussian", "heap")[pick.other % 4]
    return edits.set_shape_kind(system, variable.name, variable.terms[pick.term % len(variable.terms)].name, kind)


def _set_inference(system: FuzzySystem, pick: Pick) -> FuzzySystem:
    changes = ({"implication": "product"}, {"aggregation": "sum"}, {"conjunction": "lukewarm"}, {"flavour": "sweet"})
    return edits.set_inference(system, **changes[pick.other % len(changes)])


def _space_terms(system: FuzzySystem, pick: Pick) -> FuzzySystem:
    return edits.space_terms(system, _variable(system, pick).name, pick.term)


def _insert_term(system: FuzzySystem, pick: Pick) -> FuzzySystem:
    variable = _variable(system, pick)
    after = variable.terms[pick.term % len(variable.terms)].name
    return edits.insert_term(system, variable.name, pick.name, after, joins=bool(pick.other % 2))


def _move_term(system: FuzzySystem, pick: Pick) -> FuzzySystem:
    variable = _variable(system, pick)
    term = variable.terms[pick.term % len(variable.terms)].name
    return edits.move_term(system, variable.name, term, pick.other % (len(variable.terms) + 1))


def _paint_grid(system: FuzzySystem, pick: Pick) -> FuzzySystem:
    names = [None, *(term.name for term in system.outputs[0].terms)]
    return edits.set_cell(system, pick.term, pick.other, names[pick.variable % len(names)], edits.default_grid(system))


def _turn_rules(system: FuzzySystem) -> FuzzySystem:
    grid = edits.default_grid(system)
    return edits.dissolve_table(system) if grid is None or system.rules.table else edits.give_table(system, grid)


def _edit_list(system: FuzzySystem, pick: Pick) -> FuzzySystem:
    if pick.other % 2:
        return edits.remove_rule(system, pick.term)
    return edits.set_weight(system, pick.term, pick.share)


CHANGES: tuple[Callable[[FuzzySystem, Pick], FuzzySystem], ...] = (
    *(_move, _paint, _rename_term, _remove_term, _add_term, _rename_variable, _set_range, _set_shape, _set_inference),
    *(_space_terms, _insert_term, _move_term, _paint_grid, _edit_list),
    lambda system, _: _turn_rules(system),
    lambda system, _: edits.fill_diagonal(system),
    lambda system, _: edits.clear_table(system),
    lambda system, pick: edits.set_notes(system, pick.name),
)

picks = st.builds(
    Pick, st.integers(0, 5), st.integers(0, 7), st.integers(0, 7), st.floats(-0.25, 1.5), strategies.names
)
any_edits = st.builds(
    lambda change, pick: Edit("edit", partial(change, pick=pick)), st.sampled_from(CHANGES[:14]), picks
) | (
    st.builds(
        lambda change, pick: Edit("edit", lambda system: change(system, pick)), st.sampled_from(CHANGES[14:]), picks
    )
)
documents = st.sampled_from((DIAGONAL, PILTAN)) | strategies.systems(name=strategies.names)


@given(documents, st.lists(any_edits, max_size=12))
@settings(max_examples=100)
def test_undoing_all_edits_gives_the_same_file_and_redoing_them_the_edited_one(document, events):
    state = initial(document)
    text = dumps(document)
    seen = [document]
    for event in events:
        edited = update(state, event)
        assert (edited.document is state.document) == (len(edited.past) == len(state.past))
        if edited.document is not state.document:
            seen.append(edited.document)
        state = edited
    final = dumps(state.document)
    for expected in reversed(seen[:-1]):
        state = update(state, Undo())
        assert state.document == expected
    assert dumps(state.document) == text
    assert not state.is_unsaved
    assert state.past == ()
    for expected in seen[1:]:
        state = update(state, Redo())
        assert state.document == expected
    assert dumps(state.document) == final
    assert state.future == ()


@given(documents, st.lists(any_edits, max_size=8))
@settings(max_examples=60)
def test_a_refused_edit_keeps_the_document_and_says_why(document, events):
    state = initial(document)
    for event in events:
        why = None
        try:
            expected = event.change(state.document)
        except FuzzyError as error:
            why, expected = str(error), state.document
        edited = update(state, event)
        assert edited.document == expected
        if why is None:
            assert edited.notice is None
        else:
            assert edited.document is state.document
            assert (edited.past, edited.future, edited.runs) == (state.past, state.future, state.runs)
            assert edited.notice == Notice(f"Not done: {why}.", is_error=True)
        state = edited


any_events = st.one_of(
    any_edits,
    st.builds(Undo),
    st.builds(Redo),
    st.builds(JumpedTo, st.integers(-4, 4)),
    st.builds(
        lambda **changes: DesignChanged(changes),
        grid=st.none() | st.just(edits.Grid("e", "de", "T", (Is("x", "low"),))),
        rule=st.none() | st.integers(0, 9),
        probe=st.none() | st.just((0.1, 0.2)),
    ),
    st.builds(lambda document: Opened(document, "other.yaml", STAMP, ("other.yaml",)), documents),
    st.builds(lambda document: Uploaded(Upload("other.fis", document)), documents),
    st.builds(Imported),
    st.builds(Begun, documents),
    st.sampled_from(
        [
            StudyOrdered(),
            FitOrdered(),
            FitChosen("least greatest error"),
            StudyCancelled(),
            StudyChosen(50),
            StudyProgressed(1, 0.5),
        ]
    ),
    st.just(StudyFinished(1, None)),
    st.builds(lambda document: Saved(document, "mine.yaml", STAMP, ("mine.yaml",)), documents),
    st.builds(lambda name: Selected({"variable": name}), strategies.names),
    st.builds(lambda name: Selected({"term": name}), strategies.names),
    st.builds(lambda name: Selected({"brush": name}), strategies.names | st.none()),
    st.builds(lambda name: SetupChanged({"scenario": name}), st.sampled_from(("step", "sinus"))),
    st.builds(lambda playing: PlaybackChanged({"is_playing": playing}), st.booleans()),
    st.builds(ResetRequested),
    st.builds(lambda document: RunFinished(document, Setup(), result("a"), result("pid")), documents),
    st.builds(Progressed, st.none() | st.just("compiling")),
    st.builds(lambda text: Noticed(Notice(text)), strategies.names),
)


@given(documents, st.lists(any_events, max_size=12))
@settings(max_examples=100)
def test_after_any_event_the_selections_exist_and_the_state_before_is_as_it_was(document, events):
    state = initial(document)
    for event in events:
        before = {field: getattr(state, field) for field in state.__struct_fields__}
        changed = update(state, event)
        assert all(getattr(state, field) is value for field, value in before.items())
        state = changed
        by_name = {variable.name: [term.name for term in variable.terms] for variable in variables(state.document)}
        assert state.term in by_name[state.variable]
        grid = state.design.grid
        assert grid is None or state.brush is None or state.brush in by_name[grid.output]
        assert (grid is None) == (len(state.document.inputs) < 2)
        assert grid is None or all(said.term in by_name[said.variable] for said in grid.slice)
        assert state.design.rule is None or state.design.rule < len(state.document.rules.list)
        assert state.design.probe is None or len(state.design.probe) == len(state.document.inputs)
        assert len(state.past) <= HISTORY_LENGTH
        saved = state.source.saved
        assert state.is_unsaved == (saved is None or dumps(state.document) != dumps(saved))


@pytest.mark.parametrize(
    ("selected", "event"),
    [
        ({"variable": "e", "term": "PS"}, Edit("", partial(edits.remove_term, variable="e", term="PS"))),
        ({"variable": "e", "term": "PS"}, Edit("", partial(edits.rename_term, variable="e", term="PS", name="<b>"))),
        ({"variable": "e", "term": "PS"}, Edit("", partial(edits.rename_variable, variable="e", name="error"))),
        ({"brush": "LR"}, Edit("", partial(edits.remove_term, variable="T", term="LR"))),
        ({"brush": "LL"}, Edit("", partial(edits.rename_term, variable="T", term="LL", name="left"))),
    ],
)
def test_a_selection_that_is_gone_moves_to_one_that_exists(selected, event):
    state = after(initial(DIAGONAL), Selected(selected))
    changed = update(state, event)
    assert changed.document != state.document
    assert changed.term in [t.name for v in variables(changed.document) if v.name == changed.variable for t in v.terms]
    assert changed.brush in [term.name for term in changed.document.outputs[0].terms]
    assert (changed.variable, changed.term, changed.brush) != (state.variable, state.term, state.brush)


def test_the_brush_without_a_rule_survives_an_edit():
    state = after(initial(DIAGONAL), Selected({"brush": None}), paint(0, 0, "Z"))
    assert state.brush is None


# Gestures


@pytest.mark.parametrize("count", [2, 5, 40])
def test_edits_of_one_gesture_are_one_step(count):
    start = initial(DIAGONAL)
    values = [0.34 + 0.005 * n for n in range(count)]
    dragged = after(start, *(move(value, at=0.9 * GESTURE_SECONDS * n) for n, value in enumerate(values)))
    assert len(dragged.past) == 1
    assert dragged.document == after(start, move(values[-1])).document
    assert dragged.past[0].label == f"move to {values[-1]:g}"
    undone = update(dragged, Undo())
    assert undone.document == DIAGONAL
    assert update(undone, Redo()).document == dragged.document


@pytest.mark.parametrize(
    ("second", "why"),
    [
        (move(0.4, at=10.0 + GESTURE_SECONDS), "too late"),
        (move(0.4, "drag something else", at=10.1), "another gesture"),
        (move(0.4, "", at=10.1), "no gesture"),
    ],
)
def test_other_edits_are_steps_of_their_own(second, why):
    state = after(initial(DIAGONAL), move(0.38, at=10.0), second)
    assert len(state.past) == 2, why
    assert update(state, Undo()).document == after(initial(DIAGONAL), move(0.38)).document


def test_edits_without_a_gesture_never_merge():
    state = after(initial(DIAGONAL), paint(0, 0, "Z"), paint(0, 0, "SL"))
    assert len(state.past) == 2


def test_a_gesture_does_not_continue_into_a_step_that_was_undone():
    state = after(initial(DIAGONAL), paint(0, 0, "Z"), move(0.38, at=1.0), Undo(), move(0.4, at=1.1))
    assert len(state.past) == 2
    assert update(state, Undo()).document == after(initial(DIAGONAL), paint(0, 0, "Z")).document


def test_a_gesture_ends_when_something_else_was_edited_in_between():
    state = after(initial(DIAGONAL), move(0.38, at=1.0), paint(0, 0, "Z"), move(0.4, at=1.2))
    assert len(state.past) == 3


# History


def test_the_history_is_bounded_and_keeps_the_latest_steps():
    extra = 7
    state = initial(DIAGONAL)
    for n in range(HISTORY_LENGTH + extra):
        state = update(state, Edit(f"note {n}", partial(edits.set_notes, notes=str(n))))
    assert len(state.past) == HISTORY_LENGTH
    for _ in range(HISTORY_LENGTH):
        state = update(state, Undo())
    assert state.document.notes == str(extra - 1)
    assert state.past == ()
    assert update(state, Undo()).document is state.document


@pytest.mark.parametrize(("event", "word"), [(Undo(), "undo"), (Redo(), "redo")])
def test_with_nothing_to_take_back_or_do_again_the_state_says_so(event, word):
    state = update(initial(DIAGONAL), event)
    assert state.document is DIAGONAL
    assert state.notice == Notice(f"Nothing to {word}.")


def test_an_edit_after_undo_forgets_what_could_be_redone():
    state = after(initial(DIAGONAL), paint(0, 0, "Z"), Undo(), paint(1, 1, "Z"))
    assert state.future == ()
    assert after(state, Redo()).document is state.document


def test_an_edit_without_effect_is_no_step():
    present = edits.rule_table(DIAGONAL).cells[0][0]
    state = after(initial(DIAGONAL), paint(0, 0, "Z"), Undo(), paint(0, 0, present))
    assert state.past == ()
    assert len(state.future) == 1


def test_labels_name_what_is_undone_and_done_again():
    edited = update(initial(DIAGONAL), Edit("blacken it", partial(edits.set_notes, notes="black")))
    undone = update(edited, Undo())
    redone = update(undone, Redo())
    for state in (undone, redone):
        assert state.notice is not None
        assert "blacken it" in state.notice.text
        assert not state.notice.is_error


# Files


def opened(document: FuzzySystem, file: str = "piltan.yaml") -> Opened:
    return Opened(document, file, STAMP, ("diagonal.yaml", file))


def test_opening_a_file_can_be_undone_so_that_unsaved_work_is_never_lost():
    edited = update(initial(DIAGONAL, file="diagonal.yaml"), paint(0, 0, "Z"))
    other = update(edited, opened(PILTAN))
    assert (other.document, other.file, other.source.stamp) == (PILTAN, "piltan.yaml", STAMP)
    assert other.files == ("diagonal.yaml", "piltan.yaml")
    assert not other.is_unsaved
    back = update(other, Undo())
    assert back.document == edited.document
    assert back.is_unsaved
    assert after(back, Redo()).document == PILTAN


def test_saved_and_unsaved_follow_the_document_not_the_history():
    start = initial(DIAGONAL, file="diagonal.yaml")
    assert not start.is_unsaved
    edited = update(start, paint(0, 0, "Z"))
    assert edited.is_unsaved
    assert not update(edited, Undo()).is_unsaved
    saved = update(edited, Saved(edited.document, "new.yaml", STAMP, ("new.yaml",)))
    assert not saved.is_unsaved
    assert (saved.file, saved.source.stamp, saved.files) == ("new.yaml", STAMP, ("new.yaml",))
    assert saved.past == edited.past
    again = update(saved, paint(0, 1, "Z"))
    assert again.is_unsaved
    assert not after(again, Undo()).is_unsaved
    assert after(again, Undo(), Undo()).is_unsaved


def test_an_edit_while_the_file_is_written_stays_unsaved():
    edited = update(initial(DIAGONAL), paint(0, 0, "Z"))
    later = update(edited, paint(0, 1, "Z"))
    saved = update(later, Saved(edited.document, "diagonal.yaml", STAMP, ()))
    assert saved.document is later.document
    assert saved.is_unsaved


# Runs


def finished(state: AppState, name: str) -> AppState:
    return update(state, RunFinished(state.document, state.setup, result(name), result("pid")))


def test_the_run_before_an_edit_is_kept_to_compare_with():
    state = finished(initial(DIAGONAL), "0")
    assert state.runs.before is None
    edited = update(state, paint(0, 0, "Z"))
    assert edited.runs.before == result("0")
    again = finished(edited, "1")
    assert (again.runs.current, again.runs.before) == (result("1"), result("0"))
    undone = update(again, Undo())
    assert undone.runs.before == result("1")
    opened_ = update(finished(undone, "2"), opened(PILTAN))
    assert opened_.runs.before == result("2")


def test_during_a_gesture_the_run_before_it_stays():
    state = finished(initial(DIAGONAL), "0")
    for n in range(5):
        state = finished(update(state, move(0.35 + 0.01 * n, at=0.1 * n)), f"drag {n}")
        assert state.runs.before == result("0")
    assert state.runs.current == result("drag 4")


def test_a_refused_edit_keeps_the_runs():
    state = finished(update(finished(initial(DIAGONAL), "0"), paint(0, 0, "Z")), "1")
    refused = update(state, paint(0, 0, "no such term"))
    assert refused.runs is state.runs


def test_a_run_for_another_setup_is_ignored():
    state = finished(initial(DIAGONAL), "0")
    late = RunFinished(DIAGONAL, Setup(scenario="sinus"), result("late"), result("pid"))
    assert update(state, late) is state
    changed = update(state, SetupChanged({"scenario": "sinus"}))
    assert changed.setup == Setup(scenario="sinus")
    assert changed.runs.before is None
    assert update(changed, late).runs.current == result("late")


def test_nothing_but_edits_touches_the_document():
    state = initial(DIAGONAL)
    events: list[Event] = [
        Selected({"coordinate": 3}),
        SetupChanged({"controller": "pid"}),
        PlaybackChanged({"source": "replay", "time": 1.5}),
        Progressed(None),
        Noticed(Notice("hello")),
    ]
    for event in events:
        state = update(state, event)
    assert state.document is DIAGONAL
    assert state.past == ()
    assert (state.coordinate, state.playback.time, state.progress) == (3, 1.5, None)
    reset = update(state, ResetRequested())
    assert reset.playback.time == 0.0
    assert reset.playback.resets != state.playback.resets


def test_runs_are_kept_in_the_first_free_colour_under_names_of_their_own():
    state = update(update(initial(DIAGONAL), RunKept()), RunFinished(DIAGONAL, Setup(), result("a"), result("pid")))
    assert state.runs.kept == ()
    for _ in range(6):
        state = update(state, RunKept())
    assert [one.slot for one in state.runs.kept] == [0, 1, 2, 3]
    assert len({one.name for one in state.runs.kept}) == 4
    assert state.notice is not None
    assert state.notice.is_error
    state = update(update(state, KeptRemoved(1)), KeptRenamed(2, "mine"))
    assert [(one.slot, one.name == "mine") for one in state.runs.kept] == [(0, False), (2, True), (3, False)]
    refused = update(state, KeptRenamed(3, "mine"))
    assert refused.runs.kept == state.runs.kept
    state = update(update(state, Edit("other", lambda _: PILTAN)), RunKept())
    assert [one.slot for one in state.runs.kept] == [0, 1, 2, 3]
    assert state.runs.kept[1].result == result("a")
    assert update(state, KeptRemoved(9)).runs.kept == state.runs.kept


def test_another_scenario_or_law_gets_its_own_defaults():
    state = initial(DIAGONAL)
    for changes in ({"bend": 0.5, "gu": 2.0, "damping_ratio": 0.7}, {"mass": 1.3}, {"natural_frequency": 20.0}):
        state = update(state, SetupChanged(changes))
    other = update(state, SetupChanged({"scenario": "sinus"})).setup
    assert (other.bend, other.natural_frequency, other.gu, other.mass) == (None, None, 2.0, 1.3)
    other = update(state, SetupChanged({"controller": "pd_flc"})).setup
    assert (other.bend, other.natural_frequency, other.gu, other.damping_ratio) == (0.5, 20.0, 1.0, 1.0)


def test_every_event_is_handled():
    """A new kind of event without a case would fail here, not in the browser."""
    kinds = set(cast("Any", app_state.Event).__args__)
    assert kinds == {
        *(Edit, Undo, Redo, JumpedTo, Opened, Uploaded, Imported, Saved, Selected, DesignChanged, SetupChanged),
        *(PlaybackChanged, ResetRequested, RunFinished, Progressed, Noticed, Recovered, Asked),
        *(RunKept, KeptRenamed, KeptRemoved, Advised, SurfaceFound, Begun),
        *(StudyChosen, StudyOrdered, FitChosen, FitOrdered, StudyCancelled, StudyProgressed, StudyFinished),
    }
    with pytest.raises(AssertionError):
        update(initial(DIAGONAL), cast("Event", object()))


def test_a_jump_is_as_many_steps_and_back_again():
    state = initial(DIAGONAL, file="diagonal.yaml")
    visited = [state]
    for event in (paint(0, 0, "Z"), Opened(PILTAN, "piltan.yaml", STAMP, ()), paint(1, 1, "Z"), paint(2, 2, "Z")):
        state = update(state, event)
        visited.append(state)
    for steps in range(1, 5):
        jumped = update(state, JumpedTo(-steps))
        assert jumped.document == visited[-1 - steps].document
        assert jumped.source == visited[-1 - steps].source
        assert (len(jumped.past), len(jumped.future)) == (4 - steps, steps)
        again = update(jumped, JumpedTo(steps))
        assert (again.document, again.source) == (state.document, state.source)
    for impossible in (-5, 1):
        refused = update(state, JumpedTo(impossible))
        assert refused.document is state.document
        assert refused.notice is not None
        assert refused.notice.is_error
    assert update(state, JumpedTo(0)) is state


def test_what_is_being_written_belongs_to_what_was_chosen_and_ends_with_the_edit():
    state = after(initial(DIAGONAL), DesignChanged({"term_name": "big", "rule_text": "if", "marked": ((0, 0),)}))
    assert update(state, Selected({"brush": "LL"})).design == state.design
    assert update(state, Selected({"term": "PS"})).design.term_name is None
    edited = update(state, paint(0, 0, "Z")).design
    assert (edited.term_name, edited.rule_text, edited.marked) == (None, None, ())
    assert update(state, paint(0, 0, "no such term")).design == state.design
    assert update(state, Undo()).design == state.design, "there was nothing to undo"


def test_choices_that_the_document_does_not_have_are_dropped():
    state = initial(DIAGONAL)
    changes = {"rule": 3, "probe": (1.0,), "grid": edits.Grid("e", "x", "T")}
    assert update(state, DesignChanged(changes)).design == Design(grid=edits.Grid("e", "de", "T"))


def test_undoing_an_opening_gives_back_the_file_too_so_that_saving_overwrites_no_other():
    edited = update(initial(DIAGONAL, file="diagonal.yaml"), paint(0, 0, "Z"))
    other = update(edited, Opened(PILTAN, "piltan.yaml", STAMP, ("diagonal.yaml", "piltan.yaml")))
    back = update(other, Undo())
    assert back.source == edited.source
    assert back.is_unsaved
    again = update(back, Redo())
    assert (again.document, again.source) == (PILTAN, other.source)
    assert update(again, Undo()).source == edited.source
    assert update(update(other, paint(0, 0, "Z")), Undo()).source == other.source


def test_recovered_work_comes_with_its_history_and_its_file():
    left = update(update(initial(DIAGONAL, file="diagonal.yaml", stamp=STAMP), paint(0, 0, "Z")), paint(0, 1, "Z"))
    left = update(left, Undo())
    fresh = initial(DIAGONAL, file="diagonal.yaml", stamp=Stamp(9, 9, "9"))
    recovered = update(update(fresh, Asked(Conflict("x", STAMP))), Recovered(left.work))
    assert (recovered.document, recovered.past, recovered.future) == (left.document, left.past, left.future)
    assert recovered.question is None
    assert recovered.source == fresh.source, "the file holds a document of this history: nobody else has changed it"
    foreign = update(initial(PILTAN, file="diagonal.yaml", stamp=Stamp(9, 9, "9")), Recovered(left.work))
    assert foreign.work == left.work
    assert update(recovered, Redo()).work.document == update(left, Redo()).work.document
    assert update(recovered, Undo()).document == DIAGONAL


def test_recovering_loses_nothing_of_what_was_edited_meanwhile():
    left = update(initial(DIAGONAL, file="diagonal.yaml", stamp=STAMP), paint(0, 0, "Z"))
    other = update(initial(PILTAN, file="piltan.yaml"), paint(1, 1, "Z"))
    state = update(other, Recovered(left.work))
    assert (state.document, state.source) == (left.document, left.source)
    seen = [(state.document, state.file)]
    while state.past:
        state = update(state, Undo())
        seen.append((state.document, state.file))
    assert (other.document, "piltan.yaml") in seen
    assert (PILTAN, "piltan.yaml") in seen
    assert seen[-1] == (DIAGONAL, "diagonal.yaml")


def test_work_is_unsaved_also_where_it_was_left_by_opening_another_file():
    state = initial(DIAGONAL, file="diagonal.yaml", stamp=STAMP)
    assert not state.work.is_unsaved
    opened = update(state, Opened(PILTAN, "piltan.yaml", STAMP, ()))
    assert not opened.work.is_unsaved
    left = update(update(state, paint(0, 0, "Z")), Opened(PILTAN, "piltan.yaml", STAMP, ()))
    assert left.work.is_unsaved
    assert Work(left.document, left.source).is_unsaved is False


def test_a_file_that_was_saved_while_another_was_opened_is_not_taken_for_that_one():
    state = update(initial(DIAGONAL, file="diagonal.yaml", stamp=STAMP), paint(0, 0, "Z"))
    opened = update(state, Opened(PILTAN, "piltan.yaml", STAMP, ()))
    saved = update(opened, Saved(state.document, "diagonal.yaml", Stamp(3, 4, "5"), (), origin=state.source))
    assert (saved.document, saved.file) == (PILTAN, "piltan.yaml")
    back = update(saved, Undo())
    assert (back.file, back.source.stamp, back.is_unsaved) == ("diagonal.yaml", Stamp(3, 4, "5"), False)
