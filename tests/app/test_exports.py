"""Files of a run: every number comes back, pictures are pictures, and a browser gets what it asked for."""

from __future__ import annotations

import asyncio
import io
import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

import fuzzy
from app import exports
from app.experiment import prepare
from app.runner import result_of
from app.state import AppState, Event, Noticed, Result, RunFinished, RunKept, Setup, initial, update
from app.views.export import ExportView, maker
from fuzzy import edits
from fuzzy.formats import load

DIAGONAL = edits.set_name(load(Path(__file__).parents[2] / "rulebases" / "diagonal.yaml"), "../my <table>")


@pytest.fixture(scope="module")
def result() -> Result:
    return result_of(prepare(Setup(duration=0.5), fuzzy.compile_system(DIAGONAL)))


@pytest.fixture
def state(result: Result) -> AppState:
    state = update(initial(DIAGONAL), RunFinished(DIAGONAL, Setup(), result, result))
    return update(state, RunKept())


def test_csv_gives_every_number_back(result: Result) -> None:
    run = result.run
    text = exports.csv(run).decode()
    names = text.partition("\n")[0].split(",")
    values = np.loadtxt(io.StringIO(text), delimiter=",", skiprows=1)
    assert values.shape == (len(run.t), len(names))
    for name, expected in {
        "t": run.t,
        "q_s2": run.q[:, 1],
        "T_theta3": run.output[:, 5],
        "F11": run.forces[:, 0],
    }.items():
        np.testing.assert_array_equal(values[:, names.index(name)], expected)


def test_npz_gives_every_array_back(result: Result) -> None:
    with np.load(io.BytesIO(exports.npz(result.run)), allow_pickle=False) as found:
        np.testing.assert_array_equal(found["q"], result.run.q)
        np.testing.assert_array_equal(found["activity"], result.run.activity)
        assert found["coordinates"].tolist() == list(result.run.arm.coordinates)


def test_every_format_can_be_made_with_baselines(state: AppState) -> None:
    beginnings = {"csv": b"t,q_s1", "npz": b"PK", "png": b"\x89PNG", "html": b"<!"}
    for suffix, beginning in beginnings.items():
        assert maker(state, suffix)()[: len(beginning)].lower() == beginning.lower(), suffix


def test_a_replay_is_one_page_that_needs_nothing_else(result: Result) -> None:
    page = exports.replay_html(result.run)
    assert page.lstrip().lower().startswith("<!doctype html")
    assert len(page) > 500_000, "the viewer and the motion are in it"
    assert not re.search(r"<(script|link)[^>]+(src|href)=.https?:", page), "it needs nothing else"


class Client:
    """A browser that receives files."""

    def __init__(self) -> None:
        self.files: dict[str, bytes] = {}

    def send_file_download(self, name: str, content: bytes, *, save_immediately: bool) -> None:
        assert save_immediately
        self.files[name] = content


class Gui:
    """What the view adds."""

    def add_button_group(self, label: str, options: tuple[str, ...]) -> Any:
        return SimpleNamespace(on_click=lambda callback: setattr(self, "press", callback), label=label, options=options)

    def add_html(self, content: str) -> None:
        assert "CSV" in content


def pressed(state: AppState, *values: object) -> tuple[Client, list[Event]]:
    events: list[Event] = []
    gui, client = Gui(), Client()
    ExportView(cast("Any", gui), cast("Any", SimpleNamespace(state=state, dispatch=events.append)))

    async def press() -> None:
        clicks = [SimpleNamespace(client=client, target=SimpleNamespace(value=value)) for value in values]
        await asyncio.gather(*(cast("Any", gui).press(click) for click in clicks))

    asyncio.run(press())
    return client, events


def test_a_browser_gets_the_file_under_a_plain_name(state: AppState) -> None:
    client, events = pressed(state, "CSV")
    assert list(client.files) == ["my_table-fuzzy_flc-step.csv"]
    assert isinstance(events[0], Noticed)
    assert events[0].notice is not None
    assert not events[0].notice.is_error


def test_one_file_at_a_time_and_only_what_is_offered(state: AppState) -> None:
    client, events = pressed(state, "NPZ", "CSV", "exe", None)
    assert list(client.files) == ["my_table-fuzzy_flc-step.npz"]
    assert [event.notice.is_error for event in events if isinstance(event, Noticed) and event.notice].count(True) == 3


def test_without_a_run_there_is_nothing_to_save() -> None:
    client, events = pressed(initial(DIAGONAL), "PNG")
    assert client.files == {}
    assert isinstance(events[0], Noticed)
    assert events[0].notice is not None
    assert events[0].notice.is_error
