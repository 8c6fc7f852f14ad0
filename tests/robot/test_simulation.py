"""The closed loop: mechanics without a controller, control laws against linear theory, live against at once."""

from __future__ import annotations

import math
from typing import Any

import msgspec
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fuzzy.inference import compile_system
from fuzzy.shapes import Triangle
from fuzzy.system import FuzzySystem, Input, NoFire, Output, RuleBase, RuleTable, Term
from robot import controllers, dynamics
from robot.arm import Arm, parameters
from robot.controllers import FuzzyFlc, PdFlc, Pid
from robot.disturbance import BandLimitedNoise, Pulse, Push
from robot.errors import InvalidControllerError, RobotError, UnknownNameError
from robot.kernels import dynamics as kernels
from robot.kernels import integration
from robot.run import Run
from robot.scenario import Mismatch, Scenario, Sinus
from robot.simulation import Simulation, simulate
from tests.robot.arms import uneven_arm

SOFT = Arm.preset("soft")
STEP = Scenario.preset("step")
FREE = Pid(*[(0.0,) * 6] * 3)
"""A control law that does nothing."""


def diagonal_system(**changes: Any) -> FuzzySystem:
    """Seven triangles on e and ė, T = clip(i + j): the shape of the shipped rule bases."""

    def terms(names: str, end: float) -> tuple[Term, ...]:
        peaks = np.linspace(-end, end, 7).tolist()
        feet = [-math.inf, *peaks, math.inf]
        triangles = zip(names.split(), feet, peaks, feet[2:], strict=False)
        return tuple(Term(name, Triangle(*corners)) for name, *corners in triangles)

    labels = ["LL", "ML", "SL", "Z", "SR", "MR", "LR"]
    cells = tuple(tuple(labels[min(max(i + j - 3, 0), 6)] for j in range(7)) for i in range(7))
    output = Output("T", -85.0, 85.0, terms("LL ML SL Z SR MR LR", 85))
    return FuzzySystem(
        name="diagonal",
        inputs=(
            Input("e", -1.0, 1.0, terms("NB NM NS Z PS PM PB", 1)),
            Input("de", -6.0, 6.0, terms("FL ML SL Z SR MR FR", 6)),
        ),
        outputs=(msgspec.structs.replace(output, **changes),),
        rules=RuleBase(table=RuleTable("e", "de", "T", cells)),
    )


CONTROLLER = compile_system(diagonal_system())


def law(name: str, arm: Arm = SOFT, scenario: Scenario = STEP) -> controllers.ControlLaw:
    return controllers.default(name, arm, scenario, CONTROLLER)


def assert_same(one: Run, other: Run) -> None:
    for name, value in one._asdict().items():
        if isinstance(value, np.ndarray):
            assert np.array_equal(value, getattr(other, name)), name


def free_fall(arm: Arm, q: np.ndarray, seconds: float, reading: dynamics.Reading = "internal") -> Run:
    scenario = msgspec.structs.replace(STEP, reading=reading)
    simulation = Simulation(arm, FREE, scenario, q=q, history=seconds + 0.001)
    simulation.advance(round(seconds * 1000) + 1)
    return simulation.run()


def total_energy(arm: Arm, run: Run, every: int = 50) -> np.ndarray:
    rows = zip(run.q[::every], run.dq[::every], strict=True)
    return np.array([dynamics.energy(arm, q, dq).total for q, dq in rows])


DISPLACED = dynamics.equilibrium(SOFT) + np.array([0.02, -0.02, 0.03, 0.5, -0.4, 0.3])


def test_without_dampers_and_forces_energy_is_conserved() -> None:
    arm = SOFT.scaled(damping=0.0)
    before = dynamics.energy(arm, DISPLACED, np.zeros(6)).total
    end = integrated(arm, DISPLACED, np.zeros(6), 5.0, 0.00025)
    assert np.abs(end[6:]).max() > 0.1
    assert dynamics.energy(arm, end[:6], end[6:]).total == pytest.approx(before, abs=1e-8)


def test_with_dampers_energy_never_grows_and_the_arm_comes_to_rest_at_the_equilibrium() -> None:
    run = free_fall(SOFT, DISPLACED, 30.0)
    assert (np.diff(total_energy(SOFT, run, 20)) <= 1e-13).all()
    np.testing.assert_allclose(run.q[-1], dynamics.equilibrium(SOFT), atol=1e-5)


def test_at_the_equilibrium_nothing_moves() -> None:
    run = free_fall(SOFT, dynamics.equilibrium(SOFT), 1.0)
    np.testing.assert_allclose(run.q, np.tile(run.q[0], (len(run.q), 1)), atol=1e-14)


def integrated(arm: Arm, q: np.ndarray, tau: np.ndarray, seconds: float, step: float, reading: int = 0) -> np.ndarray:
    n = arm.n_modules
    q, dq = q.copy(), np.zeros(2 * n)
    work, stages = kernels.new_workspace(n), integration.new_stages(2 * n)
    for _ in range(round(seconds / step)):
        integration.advance(
            parameters(arm), reading, q, dq, tau, np.zeros(2 * n), np.zeros((n, 2)), step, 1, work, stages
        )
    return np.concatenate([q, dq])


def reference_solution(
    arm: Arm, q: np.ndarray, tau: np.ndarray, seconds: float, reading: dynamics.Reading
) -> np.ndarray:
    """SciPy's Dormand-Prince method of order 8, with D, C, B, G as matrices instead of the recursion."""
    n = 2 * arm.n_modules

    def rate(_: float, x: np.ndarray) -> np.ndarray:
        force = dynamics.force_matrix(arm, x[:n], reading) @ tau
        force -= dynamics.coriolis_vector(arm, x[:n], x[n:]) + dynamics.damping_vector(arm, x[n:])
        force -= dynamics.gravity_vector(arm, x[:n])
        return np.concatenate([x[n:], np.linalg.solve(dynamics.mass_matrix(arm, x[:n]), force)])

    start = np.concatenate([q, np.zeros(n)])
    return solve_ivp(rate, (0, seconds), start, method="DOP853", rtol=1e-11, atol=1e-13).y[:, -1]


@pytest.mark.parametrize("reading", ["internal", "paper"])
def test_the_integrator_agrees_with_scipy_and_is_of_order_four(reading: dynamics.Reading) -> None:
    tau = np.array([1.0, -2.0, 0.5, 1.5, -0.5, 1.0])
    exact = reference_solution(SOFT, DISPLACED, tau, 0.5, reading)
    code = dynamics.READINGS[reading]
    errors = [
        np.abs(integrated(SOFT, DISPLACED, tau, 0.5, step, code) - exact).max() for step in (0.005, 0.0025, 0.00125)
    ]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    np.testing.assert_allclose(orders, 4, atol=0.3)
    assert np.abs(integrated(SOFT, DISPLACED, tau, 0.5, 0.001, code) - exact).max() < 1e-5


@pytest.mark.parametrize("n", [1, 2, 5])
def test_other_numbers_of_modules_move_as_scipy_says(n: int) -> None:
    arm = uneven_arm(n)
    q = dynamics.equilibrium(arm) + np.concatenate([np.full(n, 0.01), np.full(n, 0.2)])
    exact = reference_solution(arm, q, np.ones(2 * n), 0.3, "internal")
    np.testing.assert_allclose(integrated(arm, q, np.ones(2 * n), 0.3, 0.0005), exact, atol=1e-6)


def test_pid_on_the_soft_arm_overshoots_by_two_point_eight_per_cent() -> None:
    metrics = simulate(SOFT, law("pid"), STEP).metrics()
    assert metrics.overshoot["worst"] == pytest.approx(2.8, abs=0.1)
    assert metrics.settling_time["worst"] == pytest.approx(0.84, abs=0.01)
    assert metrics.steady_state_error["worst"] < 0.01


@pytest.mark.parametrize(("name", "held"), [("soft", 0.02), ("stiff", 0.12)])
def test_pd_flc_gives_every_coordinate_the_linear_error_dynamics(name: str, held: float) -> None:
    """ë + Kv ė + Kp e = 0: at every control step exactly, and with ζ = 1 e = A (1 + ωt) e^{-ωt}.

    But for the hold: dampers slow a light rod within 1/40 s (soft) or 1/150 s (stiff), of which 1 ms is a good part.
    """
    arm = Arm.preset(name)
    run = simulate(arm, law("pd_flc", arm), STEP)
    e, de = run.reference - run.q, run.dreference - run.dq
    for k in range(0, len(run.t), 50):
        dde = -dynamics.acceleration(arm, run.q[k], run.dq[k], run.control[k])
        np.testing.assert_allclose(dde + 24 * de[k] + 144 * e[k], 0, atol=1e-8)
    expected = (1 + 12 * run.t) * np.exp(-12 * run.t)
    np.testing.assert_allclose(e / STEP.amplitude(3), np.tile(expected, (6, 1)).T, atol=held)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("n", [1, 2, 3, 5])
def test_the_default_gains_of_every_law_hold_any_arm(n: int, seed: int) -> None:
    for arm in (uneven_arm(n, seed), uneven_arm(n, seed).scaled(stiffness=8.0, damping=4.0)):
        for name in controllers.NAMES:
            run = simulate(arm, law(name, arm), STEP)
            assert run.stopped is None
            assert n > 3 or run.metrics().overshoot["worst"] < 25


def test_pid_on_the_stiff_arm_is_stable() -> None:
    arm = Arm.preset("stiff")
    metrics = simulate(arm, law("pid", arm), STEP).metrics()
    assert metrics.overshoot["worst"] < 3
    assert metrics.settling_time["worst"] < 1.5


def test_pd_flc_follows_a_sinus() -> None:
    scenario = Scenario.preset("sinus")
    assert isinstance(scenario.reference, Sinus)
    run = simulate(SOFT, law("pd_flc", scenario=scenario), scenario)
    late = run.t > 2.0
    error = np.abs(run.reference - run.q)[late] / scenario.scale(3)
    assert error.max() < 0.03
    assert math.isnan(run.metrics().overshoot["worst"])


def test_the_proposed_controller_does_not_overshoot() -> None:
    for name in ("soft", "stiff"):
        arm = Arm.preset(name)
        metrics = simulate(arm, law("fuzzy_flc", arm), STEP).metrics()
        assert metrics.overshoot["worst"] < 0.05
        assert metrics.settling_time["worst"] < 1.0


def test_fuzzy_flc_without_authority_is_pd_flc() -> None:
    fuzzy = law("fuzzy_flc")
    run = simulate(SOFT, msgspec.structs.replace(fuzzy, gu=[0.0] * 6), STEP)
    np.testing.assert_allclose(run.q, simulate(SOFT, law("pd_flc"), STEP).q, atol=1e-14)


def test_logged_inputs_outputs_and_activity_are_those_of_the_fuzzy_system() -> None:
    fuzzy = law("fuzzy_flc")
    assert isinstance(fuzzy, FuzzyFlc)
    run = simulate(SOFT, fuzzy, STEP)
    e, de = run.reference - run.q, run.dreference - run.dq
    np.testing.assert_allclose(run.inputs, np.stack([e * fuzzy.ge, de * fuzzy.gc], axis=-1), rtol=1e-12, atol=1e-12)
    for i in range(6):
        np.testing.assert_allclose(run.output[:, i], CONTROLLER.batch(run.inputs[:, i])[:, 0], rtol=1e-9, atol=1e-9)
    model = np.array([dynamics.inverse_dynamics(SOFT, *row) for row in zip(run.q, run.dq, v(fuzzy, run), strict=True)])
    np.testing.assert_allclose(run.control, model, rtol=1e-9, atol=1e-9)
    strongest = np.max([CONTROLLER.explain(*x).strength for x in run.inputs[:, 0]], axis=0)
    np.testing.assert_allclose(run.activity[0], strongest, atol=1e-12)
    assert run.activity.shape == (6, 49)
    assert (run.activity == 0).any(axis=1).all()


def v(fuzzy: FuzzyFlc, run: Run) -> np.ndarray:
    """The acceleration asked for, as the law is written."""
    e, de = run.reference - run.q, run.dreference - run.dq
    return np.array(fuzzy.kp) * e + np.array(fuzzy.kv) * de + np.array(fuzzy.gu) * run.output / 85.0


def test_both_force_readings_give_the_same_motion_without_saturation() -> None:
    """With held forces they differ within a control step only, because one of them depends on the position."""
    runs = [simulate(SOFT, law("fuzzy_flc"), msgspec.structs.replace(STEP, reading=r)) for r in dynamics.READINGS]
    assert np.abs(runs[0].q - runs[1].q).max() < 2e-3
    assert np.abs(runs[0].forces - runs[1].forces).max() > 1.0
    finals = [run.q[-1] for run in runs]
    np.testing.assert_allclose(*finals, atol=1e-6)


def test_force_limits_hold_and_the_integral_does_not_wind_up() -> None:
    limits = (-13.5, 13.5)
    run = simulate(SOFT, law("pid"), msgspec.structs.replace(STEP, force_limits=limits))
    assert run.forces.min() >= -13.5
    assert run.forces.max() == 13.5
    metrics = run.metrics()
    assert metrics.saturation["worst"] > 0.5
    assert metrics.overshoot["worst"] < 5
    assert metrics.steady_state_error["worst"] < 1


def test_an_arm_that_only_pushes_never_pulls() -> None:
    run = simulate(SOFT, law("pid"), msgspec.structs.replace(STEP, force_limits=(0.0, 60.0)))
    assert run.forces.min() == 0.0


def test_the_conditional_integral_acts_only_within_its_band() -> None:
    """Against a stiffer plant the integral removes the steady-state error; with a band of 0 it never acts."""
    scenario = msgspec.structs.replace(STEP, mismatch=Mismatch(stiffness=1.3), duration=6.0)
    plain = law("fuzzy_flc")
    integrating = msgspec.structs.replace(plain, ki=[12.0**3 / 2] * 6)
    error = simulate(SOFT, plain, scenario).metrics().steady_state_error["worst"]
    assert error > 5
    assert simulate(SOFT, integrating, scenario).metrics().steady_state_error["worst"] < error / 20
    assert_same(
        simulate(SOFT, msgspec.structs.replace(integrating, band=[0.0] * 6), scenario), simulate(SOFT, plain, scenario)
    )


def test_the_mismatch_is_the_plants() -> None:
    scenario = msgspec.structs.replace(STEP, mismatch=Mismatch(stiffness=1.3))
    run = simulate(SOFT, law("pd_flc"), scenario)
    np.testing.assert_allclose(run.start, dynamics.equilibrium(SOFT.scaled(stiffness=1.3)))
    fits = simulate(SOFT.scaled(stiffness=1.3), law("pd_flc"), STEP)
    np.testing.assert_allclose(run.q, fits.q, atol=1e-12)


@pytest.mark.parametrize("disturbance", [None, BandLimitedNoise(hold_time=0.001, seed=3)])
@pytest.mark.parametrize("name", controllers.NAMES)
def test_live_and_at_once_are_equal_bit_for_bit(name: str, disturbance: BandLimitedNoise | None) -> None:
    scenario = msgspec.structs.replace(STEP, disturbance=disturbance)
    whole = simulate(SOFT, law(name), scenario)
    live = Simulation(SOFT, law(name), scenario, history=5.0)
    sizes = iter([1, 2, 0, 1021, 3, 999, 16, 17, 942])
    while live.tick < len(whole.t):
        assert live.advance(size := next(sizes)) == size
    assert_same(whole, live.run())


@pytest.mark.parametrize("reference", ["step", "sequence", "circle"])
@pytest.mark.parametrize("channel", ["force", "measurement", "reference"])
def test_live_and_at_once_are_equal_with_everything_on(reference: str, channel: Any) -> None:
    rubbing = msgspec.structs.replace(SOFT, friction=0.2, payload=0.05, payload_offset=0.02)
    scenario = msgspec.structs.replace(
        Scenario.preset(reference),
        duration=0.6,
        prefilter=15.0,
        disturbance=BandLimitedNoise(0.05, hold_time=0.007, seed=4, channel=channel),
        pulses=(Pulse("theta3", 0.1, 0.1, 0.05),),
        pushes=(Push((1.0, 0.5), 0.2, 0.1, 1.5),),
        force_limits=(0.0, 40.0),
        valve_time=0.02,
        reading="paper",
    )
    gains = law("adaptive_fuzzy_flc", rubbing, scenario)
    whole = simulate(rubbing, gains, scenario)
    live = Simulation(rubbing, gains, scenario)
    while live.tick < len(whole.t):
        live.advance(min(37, len(whole.t) - live.tick))
    assert whole.stopped is None
    assert_same(whole, live.run())


def test_the_history_is_bounded_and_in_order() -> None:
    whole = simulate(SOFT, law("fuzzy_flc"), STEP)
    live = Simulation(SOFT, law("fuzzy_flc"), STEP, history=0.7)
    assert live.sample() is None
    assert len(live.run().t) == 0
    live.advance(1234)
    run = live.run()
    assert len(run.t) == 700
    assert run.t[-1] == pytest.approx(1.233)
    assert np.array_equal(run.q, whole.q[534:1234])
    assert np.array_equal(live.run(last=0.1).q, whole.q[1134:1234])
    sample = live.sample()
    assert sample is not None
    assert sample.t == run.t[-1]
    assert np.array_equal(sample.q, run.q[-1])
    assert np.array_equal(live.q, whole.q[1234])


def test_a_new_controller_takes_over_between_two_steps_without_a_jump() -> None:
    live = Simulation(SOFT, law("pid"), STEP)
    live.advance(100)
    q, dq = live.q, live.dq
    live.use(law("fuzzy_flc"))
    assert np.array_equal(live.q, q)
    assert np.array_equal(live.dq, dq)
    live.advance(3000)
    run = live.run()
    assert run.activity.shape == (6, 49)
    assert np.abs(np.diff(run.q, axis=0)).max() < 0.01
    np.testing.assert_allclose(run.q[-1], run.reference[-1], atol=1e-6)


def test_swapping_a_controller_for_an_equal_one_changes_nothing() -> None:
    live = Simulation(SOFT, law("fuzzy_flc"), STEP)
    for _ in range(30):
        live.advance(100)
        live.use(law("fuzzy_flc"))
    live.advance(1)
    assert_same(simulate(SOFT, law("fuzzy_flc"), STEP), live.run())


def test_equal_seeds_repeat_and_others_do_not() -> None:
    def run(seed: int) -> Run:
        return simulate(SOFT, law("pid"), msgspec.structs.replace(STEP, disturbance=BandLimitedNoise(seed=seed)))

    assert_same(run(5), run(5))
    assert not np.array_equal(run(5).q, run(6).q)


def test_noise_holds_for_its_time_and_has_the_power_of_the_holding_force() -> None:
    run = simulate(SOFT, law("pid"), Scenario.preset("step_noise"))
    changes = np.flatnonzero(np.diff(run.disturbance[:, 0])) + 1
    assert (changes % 36 == 0).all()
    assert len(changes) == 3000 // 36
    holding = dynamics.gravity_vector(SOFT, run.reference[-1])
    share = np.mean(run.disturbance[::36] ** 2 / holding**2)
    assert share == pytest.approx(0.3, rel=0.2)


def test_a_load_pulls_the_mass_it_hangs_on() -> None:
    live = Simulation(SOFT, FREE, STEP)
    live.load[2, 1] = 1.0
    live.advance(5000)
    stretch = live.q[:3] - live.start[:3]
    np.testing.assert_allclose(stretch, 1.0 / 400.0, rtol=1e-6)


def test_a_fuzzy_output_that_is_not_a_number_stops_the_run() -> None:
    silent = compile_system(diagonal_system(no_fire=NoFire("nan")))
    empty = msgspec.structs.replace(silent.system, rules=RuleBase(table=None))
    broken = controllers.default("fuzzy_flc", SOFT, STEP, compile_system(empty))
    run = simulate(SOFT, broken, STEP)
    assert run.stopped is not None
    assert (run.stopped.signal, run.stopped.coordinate, run.stopped.time) == ("fuzzy output", "s1", 0.0)
    assert len(run.t) == 0


def rejecting(names: tuple[str, ...]) -> Any:
    system = diagonal_system()
    inputs = tuple(
        msgspec.structs.replace(variable, out_of_range="reject" if variable.name in names else "clamp")
        for variable in system.inputs
    )
    return compile_system(msgspec.structs.replace(system, inputs=inputs))


@pytest.mark.parametrize("name", ["fuzzy_flc", "adaptive_fuzzy_flc"])
def test_an_input_that_its_range_rejects_stops_the_run_before_it_acts(name: str) -> None:
    run = simulate(SOFT, controllers.default(name, SOFT, STEP, rejecting(("e",))), STEP)
    assert run.stopped is not None
    assert (run.stopped.signal, run.stopped.time, len(run.t)) == ("fuzzy input", 0.0, 0)
    assert "outside a range that rejects it" in str(run.stopped)


def test_a_run_whose_inputs_stay_within_their_ranges_is_not_stopped() -> None:
    law = controllers.default("fuzzy_flc", SOFT, STEP, rejecting(("e",)))
    assert isinstance(law, FuzzyFlc)
    gentle = msgspec.structs.replace(law, ge=[gain / 5 for gain in law.ge])
    run = simulate(SOFT, gentle, STEP)
    assert run.stopped is None
    assert abs(run.inputs[:, :, 0]).max() <= 1.0
    # The rate leaves its range on the way: all that was done before is kept.
    both = controllers.default("fuzzy_flc", SOFT, STEP, rejecting(("de",)))
    assert isinstance(both, FuzzyFlc)
    swift = simulate(SOFT, msgspec.structs.replace(both, gc=[3 * gain for gain in both.gc]), STEP)
    assert swift.stopped is not None
    assert swift.stopped.signal == "fuzzy input"
    assert len(swift.t) > 0
    assert abs(swift.inputs[:, :, 1]).max() <= 6.0


def test_clamped_inputs_and_silent_rules_are_counted() -> None:
    system = diagonal_system()
    table = system.rules.table
    assert table is not None
    cells = (*table.cells[:4], *((None,) * 7,) * 3)
    sparse = msgspec.structs.replace(system, rules=RuleBase(msgspec.structs.replace(table, cells=cells)))
    law = controllers.default("fuzzy_flc", SOFT, STEP, compile_system(sparse))
    run = simulate(SOFT, law, STEP)
    unknown = msgspec.structs.replace(
        sparse, outputs=(msgspec.structs.replace(sparse.outputs[0], no_fire=NoFire("nan")),)
    )
    outputs = compile_system(unknown).batch(run.inputs.reshape(-1, 2)).reshape(-1, 6)
    np.testing.assert_array_equal(run.undefined, np.isnan(outputs).sum(axis=0))
    np.testing.assert_array_equal(run.clamped, (abs(run.inputs) > [1.0, 6.0]).any(axis=2).sum(axis=0))
    assert run.undefined.any()
    assert run.clamped.any()


def test_an_unstable_loop_stops_with_its_last_finite_states() -> None:
    unstable = PdFlc(SOFT, kp=(1e6,) * 6, kv=(1e5,) * 6)
    live = Simulation(SOFT, unstable, STEP)
    made = live.advance(5000)
    assert live.stopped is not None
    assert made == live.tick < 5000
    assert live.stopped.signal in ("position", "velocity")
    assert live.stopped.time == pytest.approx((made - 1) / 1000)
    assert live.advance(10) == 0
    run = live.run()
    assert len(run.t) == made
    assert np.isfinite(run.q).all()
    assert np.isfinite(run.forces).all()
    assert np.array_equal(live.q, run.q[-1])
    assert "stopped at t = " in str(live.stopped)
    assert set(run.metrics().to_dict()) == set(run.metrics()._fields)


def test_the_number_of_integration_steps_follows_the_arm() -> None:
    assert dynamics.substeps(SOFT, 0.001) == 1
    assert dynamics.substeps(Arm.preset("stiff"), 0.001) == 2
    with pytest.raises(RobotError, match="fastest motion"):
        dynamics.substeps(msgspec.structs.replace(SOFT, inertia=1e-13), 0.001)


def test_unknown_control_laws_are_refused_with_the_valid_names() -> None:
    with pytest.raises(UnknownNameError, match=r"'pdi'; did you mean 'pid'\? valid: pid, pd_flc, fuzzy_flc, "):
        controllers.default("pdi", SOFT, STEP)
    with pytest.raises(InvalidControllerError, match="fuzzy_controller"):
        controllers.default("fuzzy_flc", SOFT, STEP)


@pytest.mark.parametrize(
    "make",
    [
        lambda: Pid((1.0,) * 6, (1.0,) * 5, (0.0,) * 6),
        lambda: Pid((1.0,) * 5, (1.0,) * 5, (0.0,) * 5),
        lambda: Pid((1.0, math.nan), (1.0,) * 2, (0.0,) * 2),
        lambda: PdFlc(SOFT, (-1.0,) * 6, (1.0,) * 6),
        lambda: PdFlc(SOFT, (math.inf,) * 6, (1.0,) * 6),
        lambda: PdFlc.default(SOFT, natural_frequency=math.nan),
        lambda: controllers.default("fuzzy_flc", SOFT, STEP, CONTROLLER, natural_frequency=0.0),
        lambda: Simulation(SOFT, Pid((1.0,) * 4, (1.0,) * 4, (0.0,) * 4), STEP),
    ],
)
def test_gains_that_do_not_fit_are_refused(make: Any) -> None:
    with pytest.raises(InvalidControllerError, match=r"found .*; valid: "):
        make()


def test_a_fuzzy_system_of_another_form_is_refused() -> None:
    system = diagonal_system()
    three = msgspec.structs.replace(
        system, inputs=(*system.inputs, msgspec.structs.replace(system.inputs[0], name="x"))
    )
    with pytest.raises(InvalidControllerError, match="3 inputs and 1 outputs"):
        controllers.default("fuzzy_flc", SOFT, STEP, compile_system(three))


@pytest.mark.parametrize("start", [[0.1] * 5, [0.1] * 5 + [math.nan], [[0.1] * 6]])
def test_a_start_that_is_no_position_is_refused(start: Any) -> None:
    with pytest.raises(RobotError, match="q: found"):
        Simulation(SOFT, FREE, STEP, q=start)
