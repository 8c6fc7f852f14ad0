"""Runs that are kept to compare with: pure functions from state to state."""

from __future__ import annotations

from msgspec.structs import replace

from app.state.model import MAX_KEPT, AppState, Kept, Notice


def keep(state: AppState) -> AppState:
    """Return the state with the present run kept, in the first colour that is free."""
    current, kept = state.runs.current, state.runs.kept
    if current is None:
        return replace(state, notice=Notice("There is no run to keep yet.", is_error=True))
    if len(kept) == MAX_KEPT:
        text = f"{MAX_KEPT} runs are kept already: remove one first."
        return replace(state, notice=Notice(text, is_error=True))
    taken = {one.slot for one in kept}
    slot = next(number for number in range(MAX_KEPT) if number not in taken)
    name = _free_name(f"{state.document.name[:40]} {state.setup.controller}", kept)
    added = Kept(name, slot, current, state.document, state.setup)
    runs = replace(state.runs, kept=tuple(sorted((*kept, added), key=lambda one: one.slot)))
    return replace(state, runs=runs, notice=Notice(f"Kept as '{name}'."))


def rename(state: AppState, slot: int, name: str) -> AppState:
    """Return the state with another name for a kept run."""
    others = [one for one in state.runs.kept if one.slot != slot]
    if any(one.name == name for one in others):
        return replace(state, notice=Notice(f"Another run is called '{name}' already.", is_error=True))
    kept = tuple(one._replace(name=name) if one.slot == slot else one for one in state.runs.kept)
    return replace(state, runs=replace(state.runs, kept=kept), notice=None)


def remove(state: AppState, slot: int) -> AppState:
    """Return the state without a kept run."""
    kept = tuple(one for one in state.runs.kept if one.slot != slot)
    return replace(state, runs=replace(state.runs, kept=kept), notice=None)


def _free_name(wanted: str, kept: tuple[Kept, ...]) -> str:
    names = {one.name for one in kept}
    candidates = (wanted, *(f"{wanted} {number}" for number in range(2, MAX_KEPT + 2)))
    return next(name for name in candidates if name not in names)
