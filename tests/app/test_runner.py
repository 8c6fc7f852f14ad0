"""Background work: the newest document wins, the arm moves on under a new law, a replay shows the run's own rows."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TypeVar

import msgspec
import numpy as np
import pytest

import fuzzy
from app import experiment
from app.experiment import Experiment
from app.runner import TICKS_PER_SECOND, LiveSimulation, Moment, Previews, Runner, sample_at
from app.state import (
    Advised,
    AppState,
    Event,
    Noticed,
    Playback,
    PlaybackChanged,
    RunFinished,
    Selected,
    Setup,
    SetupChanged,
    SurfaceFound,
    initial,
    update,
)
from fuzzy import edits
from fuzzy.formats import load
from fuzzy.system import FuzzySystem, Input, RuleBase
from robot.arm import Arm
from robot.controllers import PdFlc
from robot.pull import Pull
from robot.simulation import Simulation, simulate

RULEBASES = Path(__file__).parents[2] / "rulebases"
DIAGONAL = load(RULEBASES / "diagonal.yaml")
PILTAN = load(RULEBASES / "piltan.yaml")
PATIENCE = 60.0
"""Seconds for something that takes milliseconds on an idle machine, and longer where a kernel has to be compiled."""

Found = TypeVar("Found")


def wait_for(found: Callable[[], Found | None], what: str) -> Found:
    """Return the first value that is not None."""
    deadline = time.monotonic() + PATIENCE
    while time.monotonic() < deadline:
        value = found()
        if value is not None:
            return value
        time.sleep(0.005)
    pytest.fail(f"waited {PATIENCE:g} s for {what}")


def three_inputs() -> FuzzySystem:
    """A valid system that no block of the arm's controller can be."""
    third = Input("x", 0.0, 1.0, DIAGONAL.inputs[0].terms)
    return msgspec.structs.replace(DIAGONAL, inputs=(*DIAGONAL.inputs, third))


def noted(number: int) -> FuzzySystem:
    return edits.set_notes(DIAGONAL, f"variant {number}")


def held_back(go: threading.Event) -> None:
    assert go.wait(PATIENCE)


class Posts:
    """What a thread posted, in its order."""

    def __init__(self) -> None:
        self.events: list[Event] = []

    def __call__(self, event: Event) -> None:
        self.events.append(event)

    def runs(self) -> list[RunFinished]:
        return [event for event in self.events if isinstance(event, RunFinished)]

    def run_of(self, document: FuzzySystem) -> RunFinished:
        return wait_for(
            lambda: next((run for run in self.runs() if run.document is document), None), "the run of a document"
        )


@pytest.fixture
def live() -> Iterator[LiveSimulation]:
    started = LiveSimulation()
    yield started
    started.stop()


@pytest.fixture
def posts() -> Posts:
    return Posts()


# Previews


def test_of_many_requests_that_wait_only_the_newest_is_simulated(live: LiveSimulation, posts: Posts) -> None:
    go = threading.Event()
    previews = Previews(posts, live, lambda _: held_back(go))
    documents = [noted(n) for n in range(100)]
    for document in documents:
        previews.request(document, Setup())
    go.set()
    finished = posts.run_of(documents[-1])
    previews.stop()
    assert posts.runs() == [finished]


def test_results_come_in_the_order_of_the_requests_and_the_last_one_last(live: LiveSimulation, posts: Posts) -> None:
    previews = Previews(posts, live, lambda _: None)
    documents = [noted(n) for n in range(60)]
    for document in documents:
        previews.request(document, Setup())
        time.sleep(0.002)  # so that several of them are begun
    posts.run_of(documents[-1])
    previews.stop()
    numbers = [documents.index(run.document) for run in posts.runs()]
    assert numbers == sorted(set(numbers))
    assert numbers[-1] == len(documents) - 1


def test_a_result_is_that_of_its_own_document_and_setup(live: LiveSimulation, posts: Posts) -> None:
    previews = Previews(posts, live, lambda _: None)
    setup = Setup(scenario="sinus", arm="stiff", disturbance="force_noise")
    previews.request(PILTAN, setup)
    found = posts.run_of(PILTAN)
    previews.stop()
    wanted = experiment.prepare(setup, fuzzy.compile_system(PILTAN))
    expected = simulate(*wanted)
    assert found.setup == setup
    np.testing.assert_array_equal(found.result.run.q, expected.q)
    assert found.result.metrics.to_dict() == expected.metrics().to_dict()
    assert list(found.findings) == fuzzy.check(PILTAN)
    pid = msgspec.structs.replace(setup, controller="pid")
    plain = simulate(*experiment.prepare(pid, fuzzy.compile_system(PILTAN)))
    np.testing.assert_array_equal(found.pid.run.q, plain.q)


def test_what_cannot_run_gives_a_notice_and_the_last_good_controller_goes_on(
    live: LiveSimulation, posts: Posts
) -> None:
    previews = Previews(posts, live, lambda _: None)
    previews.request(DIAGONAL, Setup())
    posts.run_of(DIAGONAL)
    good = wait_for(lambda: live.moment, "the live simulation").law
    for bad, setup in [(three_inputs(), Setup()), (DIAGONAL, Setup(controller="magic")), (DIAGONAL, Setup(arm="leg"))]:
        before = len(posts.events)
        previews.request(bad, setup)
        event = wait_for(  # other events may still come of the run before
            lambda seen=before: next((event for event in posts.events[seen:] if isinstance(event, Noticed)), None),
            "a notice",
        )
        assert event.notice is not None
        assert event.notice.is_error
        assert "valid" in event.notice.text
        assert live.moment is not None
        assert live.moment.law is good
    previews.request(PILTAN, Setup())
    posts.run_of(PILTAN)
    previews.stop()


def test_threads_end(posts: Posts) -> None:
    before = set(threading.enumerate())
    runner = Runner(posts, lambda _: None)
    started = set(threading.enumerate()) - before
    assert len(started) == 2
    runner.render(initial(DIAGONAL))
    posts.run_of(DIAGONAL)
    runner.stop()
    assert not any(thread.is_alive() for thread in started)


# The live simulation


def prepared(document: FuzzySystem = DIAGONAL, setup: Setup = Setup(), duration: float = 60.0) -> Experiment:  # noqa: B008
    wanted = experiment.prepare(setup, fuzzy.compile_system(document))
    return wanted._replace(scenario=msgspec.structs.replace(wanted.scenario, duration=duration))


def moment_where(live: LiveSimulation, holds: Callable[[Moment], bool], what: str) -> Moment:
    def found() -> Moment | None:
        moment = live.moment
        return moment if moment is not None and holds(moment) else None

    return wait_for(found, what)


def started_at(live: LiveSimulation, wanted: Experiment, least: float = 0.25) -> Moment:
    """Let an experiment run for a while, pause it in the middle of the motion, and return where it stands."""
    live.follow(Playback())
    live.use(wanted)
    moment_where(live, lambda moment: moment.sample.t >= least, "the motion")
    return paused(live)


def paused(live: LiveSimulation) -> Moment:
    live.follow(Playback(is_playing=False))
    return moment_where(live, lambda moment: moment.factor == 0.0 and moment.sample.t > 0.0, "the pause")


@pytest.mark.parametrize(
    "law",
    [prepared(PILTAN), prepared(edits.clear_table(DIAGONAL)), prepared(setup=Setup(controller="pid"))],
    ids=["another table", "no rules", "pid"],
)
def test_a_new_law_takes_over_where_the_arm_is(live: LiveSimulation, law: Experiment) -> None:
    still = started_at(live, prepared())
    live.use(law)
    swapped = moment_where(live, lambda moment: moment.law is law.law, "the new law")
    assert swapped.sample.t == still.sample.t
    np.testing.assert_array_equal(swapped.sample.q, still.sample.q)
    live.follow(Playback())
    gone_on = moment_where(live, lambda moment: moment.sample.t > still.sample.t, "the motion to go on")
    expected = Simulation(*prepared())
    expected.advance(round(still.sample.t * TICKS_PER_SECOND) + 1)
    expected.use(law.law)
    expected.advance(round((gone_on.sample.t - still.sample.t) * TICKS_PER_SECOND))
    np.testing.assert_array_equal(gone_on.sample.q, expected.sample().q)  # pyright: ignore[reportOptionalMemberAccess]


def test_after_a_run_that_diverged_the_next_edit_begins_anew(live: LiveSimulation) -> None:
    wanted, edited = prepared(), prepared(PILTAN)
    live.follow(Playback())
    live.use(wanted._replace(law=PdFlc(wanted.arm, (1e6,) * 6, (1e5,) * 6)))
    moment_where(live, lambda moment: moment.stopped is not None, "the run to diverge")
    live.use(edited)
    later = moment_where(live, lambda moment: moment.law is edited.law and moment.sample.t > 0.1, "the motion anew")
    assert later.stopped is None
    expected = Simulation(*edited)
    expected.advance(round(later.sample.t * TICKS_PER_SECOND) + 1)
    np.testing.assert_array_equal(later.sample.q, expected.sample().q)  # pyright: ignore[reportOptionalMemberAccess]


@pytest.mark.parametrize("setup", [Setup(scenario="sinus"), Setup(arm="stiff"), Setup(bend=0.2)])
def test_another_experiment_begins_anew(live: LiveSimulation, setup: Setup) -> None:
    still = started_at(live, prepared())
    wanted = prepared(setup=setup)
    live.use(wanted)
    anew = moment_where(live, lambda moment: moment.law is wanted.law, "the other experiment")
    assert anew.sample.t < still.sample.t
    np.testing.assert_allclose(anew.sample.q, simulate(*prepared(setup=setup, duration=0.01)).q[0], atol=1e-9)


@pytest.mark.parametrize("setup", [Setup(disturbance="force_noise"), Setup(stiffness=1.5), Setup(greatest_force=5.0)])
def test_other_conditions_do_not_stop_the_motion(live: LiveSimulation, setup: Setup) -> None:
    still = started_at(live, prepared())
    wanted = prepared(setup=setup)
    live.use(wanted)
    changed = moment_where(live, lambda moment: moment.law is wanted.law, "the other conditions")
    assert changed.sample.t == still.sample.t
    np.testing.assert_array_equal(changed.sample.q, still.sample.q)
    live.follow(Playback())
    gone_on = moment_where(live, lambda moment: moment.sample.t > still.sample.t, "the motion to go on")
    expected = Simulation(*prepared())
    ticks = round(still.sample.t * TICKS_PER_SECOND)
    expected.advance(ticks + 1)
    expected.go_on(wanted.scenario)
    expected.use(wanted.law)
    expected.advance(round((gone_on.sample.t - still.sample.t) * TICKS_PER_SECOND))
    np.testing.assert_array_equal(gone_on.sample.q, expected.sample().q)  # pyright: ignore[reportOptionalMemberAccess]


def test_a_hand_pulls_the_arm_and_lets_go(live: LiveSimulation) -> None:
    live.use(prepared(setup=Setup(controller="pd_flc", extension=0.0, bend=0.0)))
    live.follow(Playback())
    rest = moment_where(live, lambda moment: moment.sample.t > 0.1, "the arm at rest").sample.q
    arm = Arm.preset("soft")
    tip = Pull(3.0, (0.0, 0.0)).held(arm, rest)

    def moved(moment: Moment) -> float:
        return float(Pull(3.0, (0.0, 0.0)).held(arm, moment.sample.q)[0] - tip[0])

    live.pull(Pull(3.0, (float(tip[0]) + 0.15, float(tip[1]))))
    pulled = moment_where(live, lambda moment: moved(moment) > 0.02, "the arm to give way")
    assert pulled.pull is not None
    live.pull(None)
    moment_where(live, lambda m: m.pull is None and moved(m) < 0.005, "the arm to come back")


def test_without_a_loop_the_live_simulation_ends_with_the_scenario(live: LiveSimulation) -> None:
    live.follow(Playback(loops=False))
    live.use(prepared(duration=0.2))
    end = moment_where(live, lambda moment: moment.sample.t >= 0.2, "the end")
    later = moment_where(live, lambda moment: moment is not end and moment.factor == 0.0, "a frame after the end")
    assert later.sample.t == end.sample.t
    live.follow(Playback())
    moment_where(live, lambda moment: moment.sample.t < 0.2, "the next round")


def test_the_arm_stands_still_in_a_pause_and_goes_on_from_there(live: LiveSimulation) -> None:
    still = started_at(live, prepared())
    seen = [still]
    for _ in range(5):
        seen.append(moment_where(live, lambda moment: moment is not seen[-1], "the next frame"))
    assert {moment.sample.t for moment in seen} == {still.sample.t}
    live.follow(Playback(source="replay"))
    assert moment_where(live, lambda moment: moment is not seen[-1], "a frame").sample.t == still.sample.t
    live.follow(Playback())
    assert moment_where(live, lambda moment: moment.factor > 0.0, "the motion").sample.t >= still.sample.t


def test_a_reset_begins_anew_and_the_end_of_the_scenario_too(live: LiveSimulation) -> None:
    still = started_at(live, prepared())
    live.follow(Playback(is_playing=False, resets=1))
    assert moment_where(live, lambda moment: moment.sample.t != still.sample.t, "the start").sample.t == 0.0
    short = prepared(duration=0.5)
    live.use(short)
    live.follow(Playback(resets=1))
    middle = moment_where(live, lambda m: m.law is short.law and m.sample.t > 0.3, "the middle of the scenario")
    again = moment_where(live, lambda m: m.sample.t < middle.sample.t, "the next round")
    assert again.sample.t < 0.3
    assert middle.sample.t <= 0.5 + 0.1 + 1 / TICKS_PER_SECOND


@pytest.mark.parametrize("speed", [0.1, 1.0, 5.0])
def test_simulated_time_follows_wall_time(live: LiveSimulation, speed: float) -> None:
    """Only roughly: a machine that is busy elsewhere loses time, none may gain much."""
    live.use(prepared())
    live.follow(Playback(speed=speed))
    first = moment_where(live, lambda moment: moment.factor > 0.0 and moment.sample.t > 0.0, "the motion")
    begin = time.monotonic()
    last = moment_where(live, lambda m: m.sample.t >= first.sample.t + 0.5 * speed, "half a second")
    wall = time.monotonic() - begin
    assert last.sample.t - first.sample.t <= 2.0 * speed * (wall + 0.2)
    assert 0.0 < last.factor < 3.0 * speed


def test_the_motion_is_that_of_the_simulation(live: LiveSimulation) -> None:
    wanted = prepared()
    expected = simulate(*prepared(duration=3.0))
    seen = [started_at(live, wanted, least) for least in (0.05, 0.2, 0.5)]
    for moment in seen:
        row = round(moment.sample.t * TICKS_PER_SECOND)
        np.testing.assert_array_equal(moment.sample.q, expected.q[row])
        np.testing.assert_array_equal(moment.sample.forces, expected.forces[row])


# Frames


@pytest.fixture
def runner(posts: Posts) -> Iterator[Runner]:
    started = Runner(posts, lambda _: None)
    yield started
    started.stop()


def shown(runner: Runner, posts: Posts, *events: Event, document: FuzzySystem = DIAGONAL) -> AppState:
    """Return a state whose run is there, after some events."""
    state = initial(document)
    for event in events:
        state = update(state, event)
    runner.render(state)
    state = update(state, posts.run_of(document))
    runner.render(state)
    return state


def replayed(**changes: object) -> PlaybackChanged:
    return PlaybackChanged({"source": "replay", "is_playing": False, **changes})


def test_a_replay_shows_the_row_of_the_time_that_was_scrubbed_to(runner: Runner, posts: Posts) -> None:
    state = shown(runner, posts)
    assert state.runs.current is not None
    run = state.runs.current.run
    for time_, row in [(1.234, 1234), (0.0, 0), (2.9996, 3000), (99.0, 3000), (0.0004, 0)]:
        state = update(state, replayed(time=time_))
        runner.render(state)
        frame = runner.frame(state, elapsed=0.5)
        assert frame.t == run.t[row]
        np.testing.assert_array_equal(frame.q, run.q[row])
        np.testing.assert_array_equal(frame.target, run.reference[row])
        np.testing.assert_array_equal(frame.forces, run.forces[row])


def test_a_replay_goes_on_at_its_speed_and_begins_again_at_the_end(runner: Runner, posts: Posts) -> None:
    state = update(shown(runner, posts), replayed(time=1.0, is_playing=True, speed=2.0))
    runner.render(state)
    times = []
    for elapsed in (0.0, 0.25, 0.5, 0.2, 0.2):
        frame = runner.frame(state, elapsed)
        times.append(round(frame.t, 6))
    assert times == [1.0, 1.5, 2.5, 2.9, 0.0]


@pytest.mark.parametrize("coordinate", range(6))
@pytest.mark.parametrize("document", [DIAGONAL, PILTAN], ids=["diagonal", "piltan"])
def test_firing_strengths_are_those_that_explain_gives(
    runner: Runner, posts: Posts, coordinate: int, document: FuzzySystem
) -> None:
    state = shown(runner, posts, Selected({"coordinate": coordinate}), document=document)
    controller = fuzzy.compile_system(document)
    for time_ in (0.0, 0.05, 0.2, 0.7):
        state = update(state, replayed(time=time_))
        runner.render(state)
        frame = runner.frame(state, 0.0)
        assert frame.strength is not None
        expected = controller.explain(*frame.inputs).strength
        assert expected.any()
        np.testing.assert_array_equal(frame.strength, expected)


def test_a_law_without_fuzzy_blocks_has_no_strengths(runner: Runner, posts: Posts) -> None:
    state = update(shown(runner, posts, SetupChanged({"controller": "pid"})), replayed(time=0.1))
    runner.render(state)
    frame = runner.frame(state, 0.0)
    assert frame.strength is None


@pytest.mark.parametrize("name", ["soft", "stiff"])
def test_before_anything_is_simulated_the_chosen_arm_rests(posts: Posts, name: str) -> None:
    go = threading.Event()
    runner = Runner(posts, lambda _: held_back(go))
    state = update(initial(DIAGONAL), SetupChanged({"arm": name}))
    runner.render(state)
    for source in ("live", "replay"):
        frame = runner.frame(update(state, PlaybackChanged({"source": source})), 0.1)
        assert frame.arm == Arm.preset(name)
        assert (frame.t, frame.factor, frame.strength, frame.stopped) == (0.0, 0.0, None, None)
        np.testing.assert_array_equal(frame.q, frame.target)
        assert not frame.forces.any()
    go.set()
    runner.stop()


def test_rendering_the_same_state_again_orders_nothing(runner: Runner, posts: Posts) -> None:
    state = shown(runner, posts)
    for _ in range(20):
        runner.render(state)
        runner.render(update(state, Selected({"coordinate": 2})))
    last = update(state, SetupChanged({"scenario": "sinus"}))
    runner.render(last)
    wait_for(lambda: next((run for run in posts.runs() if run.setup == last.setup), None), "the sinus")
    assert len(posts.runs()) == 2


def test_a_sample_is_a_row_of_the_run() -> None:
    run = simulate(*prepared(duration=0.1))
    sample = sample_at(run, 0.05)
    for field in ("q", "dq", "reference", "forces", "control", "inputs", "output"):
        np.testing.assert_array_equal(getattr(sample, field), getattr(run, field)[50])
    assert sample.t == run.t[50]


def test_a_document_without_rules_runs(runner: Runner, posts: Posts) -> None:
    empty = msgspec.structs.replace(DIAGONAL, rules=RuleBase())
    state = update(shown(runner, posts, document=empty), replayed(time=0.1))
    runner.render(state)
    frame = runner.frame(state, 0.0)
    assert frame.strength is not None
    assert frame.strength.shape == (0,)


def test_the_surface_comes_at_once_and_the_advice_when_the_hand_pauses(live: LiveSimulation, posts: Posts) -> None:
    previews = Previews(posts, live, lambda _: None)
    spoilt = edits.set_cell(DIAGONAL, row="Z", column="Z", consequent="LR")
    for document in (DIAGONAL, PILTAN, spoilt):
        previews.request(document, Setup())
    told = wait_for(lambda: next((event for event in posts.events if isinstance(event, Advised)), None), "advice")
    previews.stop()
    assert told.result is posts.run_of(spoilt).result
    assert told.advice
    surfaces = [event for event in posts.events if isinstance(event, SurfaceFound)]
    assert surfaces[-1].document == spoilt
    assert surfaces[-1].landscape is not None
    middle = surfaces[-1].landscape.surface.value[20, 20]
    assert middle == fuzzy.compile_system(spoilt)(0.0, 0.0)


def test_a_system_that_is_no_surface_has_none(live: LiveSimulation, posts: Posts) -> None:
    previews = Previews(posts, live, lambda _: None)
    previews.request(three_inputs(), Setup(controller="pid"))
    found = wait_for(lambda: next((one for one in posts.events if isinstance(one, SurfaceFound)), None), "no surface")
    previews.stop()
    assert found.landscape is None
