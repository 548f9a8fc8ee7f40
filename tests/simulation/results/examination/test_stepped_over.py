"""What acts within a step of an adaptive method is met, or the run says that it was passed over."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.polynomial import polynomial

import symofros as sf
from symofros.generator.codegen import interpreted
from symofros.simulation.inputs import plan_inputs
from symofros.simulation.options import SimulationOptions
from symofros.simulation.results.examination import diagnosis, stepped_over
from symofros.simulation.results.examination.paths import path_within
from symofros.simulation.results.examination.run import ExaminedRun
from symofros.simulation.results.examination.stepped_over import _bounds_of_sums, _largest_sums
from symofros.simulation.settings import Settings
from symofros.simulation.stepping.methods import METHODS
from symofros.simulation.stepping.status import Status
from symofros.simulation.stepping.stepper import Stepper
from tests.models import compiled
from tests.simulation.mechanisms import slide
from tests.simulation.rigid_scenes import G, point

ADAPTIVE = ("dopri5", "dop853", "rodas4")
CART = slide(actuated=True)


def noted(run: Any) -> list[str]:
    return [note for note in run.outcome.notes if "passes over what acts within it" in note]


@pytest.mark.parametrize("method", ADAPTIVE)
@pytest.mark.parametrize("seed", range(4))
def test_a_narrow_force_is_met_or_noted(method: str, seed: int) -> None:
    """A coasting cart meets a force on a small part of its way, which no one knows beforehand, whatever the date."""
    t0, rng = 1e4 * (seed % 2), np.random.default_rng(seed)
    at, width, force = rng.uniform(0.5, 8.0), 10 ** rng.uniform(-1.7, -0.5), rng.choice([-1, 1]) * rng.uniform(1, 20)
    law, cart = {"x": f"{force}*exp(-((x - {at})/{width})^2)"}, sf.compile(CART)
    truth = sf.simulate(cart, [0.0], [1.0], 10.0, u=law, method="rk4", dt=1e-3, output=1.0)
    run = sf.simulate(cart, [0.0], [1.0], t0 + 10.0, t0=t0, u=law, method=method)
    off = abs(run.v[-1, 0] - truth.v[-1, 0])
    assert (off < 1e-3) != bool(noted(run)), (at, width, force, off, str(run.outcome))


@pytest.mark.parametrize("method", [*ADAPTIVE, "generalized_alpha", "implicit_euler"])
@pytest.mark.parametrize("angle", [np.pi / 2, -np.pi / 2])
def test_a_double_pendulum_at_rest_bears_no_note(method: str, angle: float) -> None:
    """Hanging, or on its head as long as that stays so: what moves is rounding, or what atol allows."""
    options: dict[str, Any] = {"dt": 0.01} if method in ("generalized_alpha", "implicit_euler") else {}
    for t_end in (1.0, 10.0, 100.0):
        run = sf.simulate(compiled("double_pendulum"), [angle, 0.0], t_end=t_end, method=method, **options)
        assert run.outcome.notes == () or np.abs(run.v).max() > 1e-3, (t_end, run.outcome.notes)
        if angle > 0.0:
            assert np.abs(run.v).max() < 1e-6


@pytest.mark.parametrize("method", ADAPTIVE)
@pytest.mark.parametrize(("speed", "counts"), [(1e-5, True), (1e-12, False)])
def test_forces_that_change_slow_motions_by_more_than_the_tolerances_are_noted(
    method: str, speed: float, counts: bool
) -> None:
    """A hundred times atol, 1e-9: a bell on the way of a slow cart adds two thirds of its speed, met by no step."""
    law = {"x": f"{1000.0 * speed}*exp(-((x/{speed} - 5.0)/0.0005)^2)"}
    run = sf.simulate(sf.compile(CART), [0.0], [speed], 10.0, u=law, method=method)
    assert run.v[-1, 0] == pytest.approx(speed, rel=1e-3)  # In place of 1.67 times as fast.
    assert bool(noted(run)) == counts, str(run.outcome)


# Forces on a way of about w about x = c, and the last speed of a kilogram that comes with 1 m/s.
NARROW = {
    "bell": ("exp(-((x - {c})/{w})^2)/{w}", (1.0 + 2.0 * np.sqrt(np.pi)) ** 0.5),
    "tent": ("max(0, 1 - abs(x - {c})/{w})/{w}", 3.0**0.5),
    "window": ("(sign(x - {c}) - sign(x - {c} - {w}))/{w}", 5.0**0.5),
    "hill": ("2*(x - {c})/{w}^2*exp(-((x - {c})/{w})^2)", -1.0),
    "low hill": ("(x - {c})/{w}^2*exp(-((x - {c})/{w})^2)/2", 1.0),
    "well": ("-2*(x - {c})/{w}^2*exp(-((x - {c})/{w})^2)", 1.0),
    "corner": ("3*max(0, t - {c})*max(0, {c} + {w} - x)/{w}^3", 1.38748857),
    "own": ("exp(-((x - {c})/{w})^2)/{w}", (1.0 + 2.0 * np.sqrt(np.pi)) ** 0.5),
}


@pytest.mark.parametrize("method", [*ADAPTIVE, "rk4"])
@pytest.mark.parametrize("shape", NARROW)
def test_a_force_of_any_narrowness_is_met_or_noted_by_its_formula(method: str, shape: str) -> None:
    """A law, or a load of the description's; a hill that turns the cart round, and hills and wells that it passes."""
    (formula, last), rng = NARROW[shape], np.random.default_rng(3)
    options: dict[str, Any] = {"method": method, "dt": 0.1} if method == "rk4" else {"method": method}
    for width in (1e-5, 1e-3):
        law = formula.format(c=repr(float(rng.uniform(2.0, 8.0))), w=width)
        system, u = (CART, {"x": law}) if shape != "own" else (loaded(law), None)
        run = sf.simulate(sf.compile(system), [0.0], [1.0], 10.0, u=u, **options)
        assert (abs(run.v[-1, 0] - last) < 1e-3) != bool(noted(run)), (law, run.v[-1], str(run.outcome))


@pytest.mark.parametrize(
    ("shape", "method", "dt", "c", "w"),
    [
        ("hill", "rk4", 0.05, 5.195195312646882, 0.02589640159281024),
        ("window", "semi_implicit_euler", 0.01, 2.729589344217913, 0.02836061794577942),
    ],
)
def test_fixed_steps_that_err_together_on_a_narrow_force_are_noted(
    shape: str, method: Any, dt: float, c: float, w: float
) -> None:
    """By less than what counts in each step, and by more in all of them; half the step may err as the step does."""
    run = sf.simulate(
        sf.compile(CART), None, [1.0], 10.0, u={"x": NARROW[shape][0].format(c=c, w=w)}, method=method, dt=dt
    )
    assert abs(run.v[-1, 0] - NARROW[shape][1]) > 0.1 and noted(run), str(run.outcome)


@pytest.mark.parametrize(
    ("dt", "c", "w"), [(0.1, 8.036382369697899, 0.005447557114880878), (0.05, 4.02829742, 0.00164)]
)
def test_short_steps_prove_from_a_state_of_the_run(dt: float, c: float, w: float) -> None:
    """From amid a well that the cubic passes they would be caught in it; and too long ones follow no well."""
    law = {"x": NARROW["well"][0].format(c=c, w=w)}
    run = sf.simulate(sf.compile(CART), None, [1.0], 10.0, u=law, method="generalized_alpha", dt=dt)
    assert abs(run.v[-1, 0] - 1.0) < 1e-9 and not run.outcome.notes, str(run.outcome)


@pytest.mark.parametrize("method", ["rk4", "semi_implicit_euler", "generalized_alpha"])
@pytest.mark.parametrize("seed", range(3))
def test_fixed_steps_of_the_size_of_a_narrow_force_are_right_or_noted(method: Any, seed: int) -> None:
    rng = np.random.default_rng(seed)
    for shape in ("bell", "tent", "window", "hill", "well"):
        formula, last = NARROW[shape]
        dt, c = float(rng.choice([0.1, 0.05, 0.02])), rng.uniform(2.0, 8.0)
        law = {"x": formula.format(c=c, w=dt * 10 ** rng.uniform(-1.5, 0.5))}
        run = sf.simulate(sf.compile(CART), None, [1.0], 10.0, u=law, method=method, dt=dt)
        off = abs(run.v[-1, 0] - last)
        assert off < 0.1 * max(abs(last), np.abs(run.v).max()) or run.outcome.notes or not run.outcome.ok, (
            law,
            dt,
            off,
        )
        assert off > 1e-9 or not noted(run), (law, dt, str(run.outcome))


def loaded(force: str) -> sf.System:
    body = replace(CART.bodies[0], loads=(sf.Load(force=(force, 0, 0)),))
    return replace(CART, bodies=(body,))


@pytest.mark.parametrize("law", ["-20*x - 0.1*tanh(dx/0.2)", "-0.3*dx*abs(dx)", "-2*x/(1 + x^2)"])
def test_formulas_that_steps_resolve_are_not_searched(law: str, monkeypatch: pytest.MonkeyPatch) -> None:
    sought = list[float]()
    monkeypatch.setattr(interpreted, "find_instants", lambda *given: sought.append(given[2]) or np.zeros(0))
    run = sf.simulate(sf.compile(CART), [0.1], [1.0], 5.0, u={"x": law}, method="dopri5")
    assert run.outcome.ok and not run.outcome.notes and not sought


PULSE = "20*exp(-((t - 6.3)/0.05)^2)"


@pytest.mark.parametrize("law", [PULSE, "function"])
@pytest.mark.parametrize("method", ["dopri5", "dop853", "cvode"])
def test_a_pulse_that_a_body_at_rest_sleeps_through_is_noted(method: str, law: str) -> None:
    given: Any = {"x": law}
    if law == "function":
        given = lambda t, q, v: np.array([20.0 * np.exp(-(((t - 6.3) / 0.05) ** 2))])  # noqa: E731
    run = sf.simulate(sf.compile(CART), t_end=10.0, u=given, method=method)
    exact = 20.0 * 0.05 * np.sqrt(np.pi)
    assert (abs(run.v[-1, 0] - exact) < 1e-3) != bool(noted(run)), str(run.outcome)
    if noted(run):
        cure = float(noted(run)[0].split("max_step=")[1])
        again = sf.simulate(sf.compile(CART), t_end=10.0, u=given, method=method, max_step=cure)
        assert abs(again.v[-1, 0] - exact) < 1e-3 and not again.outcome.notes


@pytest.mark.parametrize("method", ["dopri5", "rk4", "cvode"])
def test_a_run_that_records_only_its_start_gives_no_note(method: str) -> None:
    """A record is no interval: there is nothing to look into, and no division by its length."""
    if method == "cvode":
        pytest.importorskip("sksundae")
    run = sf.simulate(sf.compile(CART), None, [1.0], 1e-3, u={"x": "t"}, method=method, output=[0.0])
    assert run.outcome.kind == "finished" and len(run.t) == 1 and not run.outcome.notes


def test_a_run_of_a_batch_is_noted_where_its_steps_miss_the_pulse() -> None:
    many = sf.simulate_batch(sf.compile(CART), np.zeros((2, 1)), [[0.0], [0.1]], 10.0, u={"x": PULSE}, method="dopri5")
    exact = 20.0 * 0.05 * np.sqrt(np.pi)
    for i, first in enumerate((0.0, 0.1)):
        assert (abs(many.v[i, -1, 0] - first - exact) < 1e-3) != bool(noted(many[i])), str(many.outcome(i))


def test_the_steps_that_leave_out_most_are_doubted_first(rng: np.random.Generator, monkeypatch: Any) -> None:
    """By the largest sum of what their states change the speeds by, beside the fastest motion."""
    missed = rng.standard_normal((10, 8, 2)) * rng.uniform(0.1, 3.0, (10, 1, 1))
    path = SimpleNamespace(interval=np.repeat(np.arange(10), 8), a=missed.reshape(-1, 2), path_a=0.0)
    monkeypatch.setattr(stepped_over, "path_within", lambda *_: path)
    metric = np.tile(np.diag([4.0, 1.0]), (10, 1, 1))
    run: Any = SimpleNamespace(stepper=None, span=5.0, metrics=lambda q, u: metric[: len(q)])
    ends = [np.arange(11) * 0.5, np.zeros((11, 2)), np.zeros((11, 2)), np.zeros((11, 1))]
    sums = np.linalg.norm(np.cumsum(missed, axis=1) * [2.0, 1.0] * 0.5 / 8, axis=-1).max(axis=1) / 50.0
    order = np.argsort(-sums)
    for least, count in ((0.0, stepped_over._PROVED), (float(sums[order[2]]) * 1.001, 2)):
        doubted = stepped_over._doubted(run, ends, 80, least, 50.0)
        assert doubted == [(i, 0.5 / 8) for i in order[:count]]


@pytest.mark.parametrize("name", ["double_pendulum", "cart_pole", "torque_free_body"])
def test_speeds_are_compared_by_their_kinetic_energy(name: str, rng: np.random.Generator) -> None:
    """In the norm of the mass matrix, in which units of speeds do not count."""
    model = compiled(name)
    q, v = (np.array(x) for x in zip(*(model.random_state(rng) for _ in range(5)), strict=True))
    u = rng.standard_normal((5, model.nu))
    settings = Settings.of(model, SimulationOptions(method="rk4", dt=0.1), 0.4)
    stepper = Stepper(model, METHODS["rk4"], plan_inputs(model, None), (), model.parameter_values)
    run = ExaminedRun(stepper, settings, (q[0], v[0]), [np.arange(5) * 0.1, q, v, u], 4)
    np.testing.assert_allclose(run.norms(q, u, v), np.sqrt(2.0 * model.kinetic_energy(q, v, u=u)), rtol=1e-12)


@pytest.mark.parametrize("stabilisation", ["projection", "baumgarte", "none"])
def test_repeated_spans_equal_the_run(stabilisation: Any) -> None:
    """To the bit, from any record on, the constraints kept as the run keeps them."""
    model = compiled("four_bar")
    start = sf.assemble(model, [1.2, -1.2, 1.2], [2.0, 0.0, 0.0])
    options = SimulationOptions(method="rk4", dt=0.01, stabilisation=stabilisation)
    made = sf.simulate(model, start.q, start.v, 0.2, method="rk4", dt=0.01, stabilisation=stabilisation)
    settings = Settings.of(model, options, 0.2)
    stepper = Stepper(model, METHODS["rk4"], plan_inputs(model, None), (), model.parameter_values)
    run = ExaminedRun(stepper, settings, (start.q, start.v), [made.t, made.q, made.v, made.u], 20)
    status, (t, q, v, _) = run.repeated([x[4] for x in run.states[:3]], float(made.t[14]), 0.01, every=2)
    assert status == Status.FINISHED
    np.testing.assert_allclose(t, made.t[4:15:2], rtol=1e-14)
    np.testing.assert_array_equal(np.hstack([q, v]), np.hstack([made.q, made.v])[4:15:2])


@pytest.mark.parametrize("wind", [0.0, 0.8])
def test_a_slide_that_is_made_once_more_is_the_run(wind: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Up to rest: the direction of friction where the slip is slow is remembered, too."""
    found = list[Any]()

    def repeat(run: ExaminedRun) -> tuple[str, ...]:
        """While the run stands at the end of the slide."""
        t = run.states[0]
        if not found:
            found.extend(run.repeated([x[i] for x in run.states[:3]], float(t[-1]), 1e-2) for i in (0, 3, len(t) - 3))
            found.append(run.states)
        return ()

    monkeypatch.setattr(diagnosis, "constraint_notes", repeat)
    sf.simulate(point(0.3, (0.0, wind, -G)), None, [1.0, 0.5, 0.0], 1.0, method="rk4", dt=1e-2)
    (t, q, v, _), ends = found.pop(), found
    assert 0.3 < t[-1] < 0.6
    for status, (times, *again, _) in ends:
        first = len(t) - len(times)
        assert status == Status.FINISHED and times == pytest.approx(t[first:], abs=1e-15)
        np.testing.assert_allclose(np.hstack(again), np.hstack([q, v])[first:], rtol=0, atol=1e-15)


def test_a_cubic_is_met_by_its_ends(rng: np.random.Generator) -> None:
    """Coordinates that are cubics of time, or speeds, with their rates, wherever they are asked for."""
    model = compiled("double_pendulum")
    stepper = Stepper(model, METHODS["rk4"], plan_inputs(model, None), (), model.parameter_values)
    t, which, x = np.array([0.3, 0.5, 1.7, 1.8]), np.array([0, 2, 2, 1, 1]), rng.uniform(size=5)
    cubic = rng.standard_normal((4, 2))
    slope, bend = polynomial.polyder(cubic), polynomial.polyder(cubic, 2)
    for of, cubics in (((cubic, slope, bend), slice(0, 3)), ((0.0 * cubic, cubic, slope), slice(1, 3))):
        q, v, a = (np.ascontiguousarray(polynomial.polyval(t, c).T) for c in of)
        t_x, *found = stepper.path((t, q, v, a), which, x)
        np.testing.assert_allclose(t_x, t[which] + x * np.diff(t)[which], rtol=1e-15)
        for got, c in zip(found[cubics], of[cubics], strict=True):
            np.testing.assert_allclose(got, polynomial.polyval(t_x, c).T, atol=1e-12)


@pytest.mark.parametrize("name", ["torque_free_body", "slider_crank"])
def test_a_path_between_records_is_the_motion(name: str) -> None:
    """Of rotations and loops as well: the states within steps are those of a run with short steps, to h^4."""
    model = compiled(name)
    if model.nc:
        start = sf.assemble(model, {"crank": 0.6} if "crank" in model.names.q else model.neutral())
        q, v = start.q, start.v
    else:
        q, v = model.random_state(np.random.default_rng(4))
    errors = []
    for dt in (0.02, 0.01):
        fine = sf.simulate(model, q, v, 0.1, method="rk4", dt=dt / 10)
        coarse = [x[::10] for x in (fine.t, fine.q, fine.v, fine.u)]
        settings = Settings.of(model, SimulationOptions(method="rk4", dt=dt / 10), 0.1)
        stepper = Stepper(model, METHODS["rk4"], plan_inputs(model, None), (), model.parameter_values)
        settings.apply(stepper)
        stepper.start(q, v, 16)
        path = path_within(stepper, coarse, np.full(len(coarse[0]) - 1, 5))
        assert path is not None
        np.testing.assert_allclose(
            path.x.reshape(-1, 5), [[0.1, 0.3, 0.5, 0.7, 0.9]] * (len(coarse[0]) - 1), rtol=1e-12
        )
        rows = np.rint(path.states[0] / (dt / 10)).astype(int)
        np.testing.assert_allclose(path.states[0], fine.t[rows], atol=1e-12)
        a = model.forward_dynamics(fine.q[rows], fine.v[rows], fine.u[rows], t=fine.t[rows])
        errors.append([np.abs(model.difference(fine.q[rows], path.states[1])).max(), np.abs(path.a - a).max()])
    assert np.all(np.array(errors[1]) < 0.1 * np.array(errors[0]) + 1e-10), errors


def test_largest_sums_are_those_of_each_interval_in_its_own_metric(rng: np.random.Generator) -> None:
    for counts in (np.array([4]), np.array([4, 7, 8, 5, 9, 33, 4])):
        roots = rng.normal(size=(len(counts), 3, 3))
        metric, changes = roots @ roots.transpose(0, 2, 1), rng.normal(size=(counts.sum(), 3))
        found = _largest_sums(changes, counts, metric)
        for k, own in enumerate(np.split(changes, np.cumsum(counts)[:-1])):
            sums = np.cumsum(own, axis=0)
            assert found[k] == pytest.approx(np.sqrt((sums @ metric[k] * sums).sum(axis=1)).max(), rel=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_sums_of_changes_stay_within_their_bounds_which_one_change_along_a_principal_axis_meets(seed: int) -> None:
    rng = np.random.default_rng(seed)
    counts = rng.integers(1, 9, 6)
    changes = rng.normal(size=(counts.sum(), 3)) * 10.0 ** rng.uniform(-3, 3, (counts.sum(), 1))
    roots = rng.normal(size=(6, 3, 3)) * 10.0 ** rng.uniform(-3, 3, (6, 1, 1))
    metric = roots @ np.swapaxes(roots, -1, -2)
    assert (_largest_sums(changes, counts, metric) <= _bounds_of_sums(changes, counts, metric) * (1 + 1e-12)).all()
    along = np.array([[0.0, 0.0, 2.0]])
    alone = np.diag([0.0, 0.0, 9.0])[np.newaxis]
    assert _largest_sums(along, np.array([1]), alone) == _bounds_of_sums(along, np.array([1]), alone) == 6.0
