"""States of forces in runs: LuGre, hysteresis and backlash against SciPy and closed forms (docs/theory/states.md)."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import symofros as sf
from tests.exports.cases import build, sources
from tests.exports.cases import run as run_program

_ACCURATE: dict[str, Any] = {"rtol": 1e-11, "atol": 1e-13}
_BRISTLES: dict[str, float] = {
    "dynamic": 2.0,
    "stiffness": 3e3,
    "damping": 20.0,
    "static": 3.0,
    "stribeck_velocity": 0.05,
    "viscous": 0.3,
}
_MASS, _DRIVE = 1.5, "4*sin(3*t)"


def block(*elements: Any, **fields: Any) -> sf.Model:
    """A block on a level slide, with a force as input."""
    joint = sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=elements, actuated=True)
    return sf.compile(sf.System("block", (sf.RigidBody("block", joint, sf.Inertia(_MASS)),), **fields))


@cache
def dragged() -> sf.Model:
    return block(sf.LuGre(**_BRISTLES))


def lugre_rate(t: float, y: np.ndarray) -> list[float]:
    """(6), (7) of the theory, written anew."""
    x, v, z = y
    g = 2.0 + 1.0 * np.exp(-((v / 0.05) ** 2))
    rate = v - 3e3 * abs(v) * z / g
    force = 4.0 * np.sin(3.0 * t) - (3e3 * z + 20.0 * rate + 0.3 * v)
    return [v, force / _MASS, rate]


@cache
def reference(t_end: float = 1.5) -> np.ndarray:
    """x, v, z at the end by SciPy."""
    found = solve_ivp(lugre_rate, (0.0, t_end), [0.0, 0.0, 1e-4], method="DOP853", rtol=1e-12, atol=1e-14)
    return np.asarray(found.y[:, -1])


def end_of(run: sf.Trajectory) -> np.ndarray:
    return np.concatenate([run.q[-1], run.v[-1], run.z[-1]])


@pytest.mark.parametrize("method", ["dopri5", "dop853", "rodas4"])
def test_lugre_against_a_fine_independent_integration(method: str) -> None:
    """Stick, slip and reversal: the end to 1e-8, by explicit methods and by one with the exact Jacobian."""
    run = sf.simulate(dragged(), t_end=1.5, z0=[1e-4], u={"x": _DRIVE}, method=method, **_ACCURATE)
    assert run.outcome.kind == "finished" and not run.outcome.notes
    assert end_of(run) == pytest.approx(reference(), abs=1e-8)
    assert run.z.shape == (len(run), 1) and run["x.bristle"] is not None and run.model is dragged()


@pytest.mark.parametrize(
    ("method", "dt", "error", "order"),
    [
        ("rk4", 2e-4, 3e-7, 1.0),
        ("generalized_alpha", 4e-4, 5e-6, 1.7),
        ("variational", 4e-4, 5e-6, 0.9),
        ("semi_implicit_euler", 1e-4, 4e-4, 0.9),
    ],
)
def test_fixed_steps_converge_to_it(method: str, dt: float, error: float, order: float) -> None:
    """Half the step, the error less by the order; the kink at v = 0 leaves less of the fourth."""
    errors = [
        np.abs(end_of(sf.simulate(dragged(), t_end=1.5, z0=[1e-4], u={"x": _DRIVE}, method=method, dt=h)) - reference())
        for h in (dt, dt / 2.0)
    ]
    largest = [float(e.max()) for e in errors]
    assert largest[0] < error and np.log2(largest[0] / largest[1]) > order


def test_sundials_has_them() -> None:
    run = sf.simulate(dragged(), t_end=1.5, z0=[1e-4], u={"x": _DRIVE}, method="cvode", rtol=1e-10, atol=1e-12)
    assert end_of(run) == pytest.approx(reference(), abs=1e-7)


def test_constant_speed_has_the_curve_of_stribeck() -> None:
    """F(v) = -(g + s2 v) once bristles have bent over, and z = g/s0."""
    model = dragged()
    for speed in (0.01, 0.05, 0.4, -0.2):
        z = [np.sign(speed) * (2.0 + np.exp(-((speed / 0.05) ** 2))) / 3e3]
        assert model.state_rates([0.0], [speed], [0.0], z=z) == pytest.approx(0.0, abs=1e-15)
        level = 2.0 + np.exp(-((speed / 0.05) ** 2)) + 0.3 * abs(speed)
        assert model.generalized_force([0.0], [speed], [0.0], z=z) == pytest.approx(-np.sign(speed) * level, rel=1e-12)


def test_bristles_hold_a_load() -> None:
    """At 0.9 of static friction, reached slowly, a block is at rest after presliding, and stays there."""
    run = sf.simulate(dragged(), t_end=30.0, u={"x": "2.7*min(t/10, 1)"}, method="rodas4", rtol=1e-9, atol=1e-13)
    assert np.abs(run.v[-1]) < 1e-12 and run.z[-1] == pytest.approx(2.7 / 3e3, rel=1e-9)
    assert 2.7 / 3e3 < run.q[-1, 0] < 1e-2


@cache
def slips() -> sf.Model:
    """Two elasto-plastic elements and a spring: a harmonic drive's wind-up."""
    return block(sf.Hysteresis(80.0, 1.0, 3.0), sf.Hysteresis(20.0, 1.5), sf.Spring(30.0))


def slip_rate(t: float, y: np.ndarray) -> list[float]:
    """(10) of the theory, written anew."""
    x, v, z1, z2 = y

    def rate(z: float, k: float, F: float, n: float) -> float:
        return v * (1.0 - abs(k * z / F) ** n) if v * z > 0.0 else v

    force = 5.0 * np.sin(3.0 * t) * np.cos(0.7 * t) - 80.0 * z1 - 20.0 * z2 - 30.0 * x
    return [v, force / _MASS, rate(z1, 80.0, 1.0, 3.0), rate(z2, 20.0, 1.5, 2.0)]


@pytest.mark.parametrize("method", ["dop853", "rodas4"])
def test_hysteresis_against_a_fine_independent_integration(method: str) -> None:
    """Minor loops and reversals: the end to 1e-8."""
    wanted = solve_ivp(slip_rate, (0.0, 3.0), [0.0] * 4, method="DOP853", rtol=1e-12, atol=1e-14, max_step=2e-3).y[
        :, -1
    ]
    run = sf.simulate(slips(), t_end=3.0, u={"x": "5*sin(3*t)*cos(0.7*t)"}, method=method, **_ACCURATE)
    assert run.outcome.kind == "finished"
    assert end_of(run) == pytest.approx(wanted, abs=1e-8)


def test_first_loading_of_dahl_is_its_closed_form() -> None:
    """n = 1: F = F_0 (1 - exp(-k q/F_0)), whatever the speed; the return is elastic."""
    model = block(sf.Hysteresis(50.0, 2.0, 1.0))
    for speed in (0.01, 3.0):
        times = np.linspace(0.0, 0.2 / speed, 200)
        z = solve_ivp(
            lambda t, z, speed=speed: model.state_rates([0.0], [speed], [0.0], z=z),
            (0.0, times[-1]),
            [0.0],
            t_eval=times,
            rtol=1e-11,
            atol=1e-13,
        ).y[0]
        assert 50.0 * z == pytest.approx(2.0 * (1.0 - np.exp(-25.0 * speed * times)), abs=1e-9)
        assert model.state_rates([0.0], [-speed], [0.0], z=[z[-1]]) == pytest.approx(-speed, rel=1e-14)


@pytest.mark.parametrize("which", ["lugre", "hysteresis"])
def test_the_energy_of_a_run_closes(which: str) -> None:
    """T + V, with what bristles and slips store, and the heat of (8) or (11), integrated beside: as at the start."""
    if which == "lugre":
        g = "(2 + exp(-(dx/0.05)^2))"
        heat = f"abs(dx)*({g}*(3000*`x.bristle`/{g})^2 + 20*abs(dx)*(1 - 3000*`x.bristle`*sign(dx)/{g}) + 0.3*abs(dx))"
        elements: tuple[Any, ...] = (sf.LuGre(**_BRISTLES), sf.Spring(40.0))
    else:
        heat = "80*abs(`x.slip`)*abs(80*`x.slip`)^3*max(dx*sign(`x.slip`), 0)"
        elements = (sf.Hysteresis(80.0, 1.0, 3.0), sf.Spring(40.0))
    model = block(*elements, states=(sf.ForceState("heat", heat),))
    run = sf.simulate(model, [0.2], [1.0], t_end=1.5, method="dop853", rtol=1e-10, atol=1e-12)
    assert run.energy + run["heat"] == pytest.approx(np.full(len(run), run.energy[0]), abs=1e-9)
    assert run["heat"][-1] > 0.3 * run.energy[0] and (np.diff(run["heat"]) > -1e-15).all()
    assert not run.outcome.notes


def test_batches_steppers_and_runs_take_the_same_steps() -> None:
    """Runs and a Stepper to the bit, batches and Steppers within rounding."""
    model, laws = dragged(), {"x": _DRIVE}
    run = sf.simulate(model, [0.1], [0.4], 0.5, z0=[2e-4], u=laws, dt=1e-3)
    stepper = sf.Stepper(model, u=laws, dt=1e-3)
    stepper.reset([0.1], [0.4], z=[2e-4])
    stepper.step(steps=500)
    assert (np.concatenate([stepper.q, stepper.v, stepper.z]) == end_of(run)).all()
    assert stepper.energy == pytest.approx(run.energy[-1], rel=1e-14) and stepper.a == pytest.approx(run.a[-1])
    assert (stepper.trajectory().z == run.z).all() and stepper.copy().z == stepper.z
    batch = sf.simulate_batch(model, [[0.0], [0.1]], [[0.0], [0.4]], 0.5, z0=[[0.0], [2e-4]], u=laws, dt=1e-3)
    assert batch.q.shape == batch.v.shape == batch.z.shape == (2, 1, 1)
    ends = (batch.q_last[1], batch.v_last[1], batch.z_last[1])
    assert np.concatenate(ends) == pytest.approx(end_of(run), abs=1e-14)
    assert batch[1].model is model and (batch[1].z[-1] == batch.z_last[1]).all() and "finished" in str(batch)
    steppers = sf.Steppers(model, 2, u=laws, dt=1e-3)
    steppers.reset([0.1], [0.4], z=[2e-4])
    steppers.step(steps=500)
    ends = (steppers.q[0], steppers.v[0], steppers.z[0])
    assert np.concatenate(ends) == pytest.approx(end_of(run), abs=1e-14)
    assert steppers.energy[1] == pytest.approx(run.energy[-1]) and steppers.outcome(0).kind == "finished"


def test_events_records_and_files_have_them(tmp_path: Path) -> None:
    """Formulas of events name states; events tell q and v of the model; columns and archives hold z."""
    model = dragged()
    run = sf.simulate(model, t_end=1.0, u={"x": _DRIVE}, events={"bent": "`x.bristle` - 5e-4"}, method="dopri5")
    assert run.events[0].q.shape == run.events[0].v.shape == (1,)
    after = np.searchsorted(run.t, run.events[0].t)
    assert run.z[after - 1, 0] <= 5e-4 <= run.z[after, 0]
    columns = run.columns()
    assert (columns["x.bristle"] == run.z[:, 0]).all() and "x.bristle.integral" not in columns
    with np.load(run.save(tmp_path / "run.npz")) as archive:
        assert (archive["z"] == run.z).all() and archive["names_z"].tolist() == ["x.bristle"]


def test_a_function_of_the_caller_sees_coordinates_and_speeds_alone() -> None:
    seen = []

    def law(t: float, q: np.ndarray, v: np.ndarray) -> list[float]:
        seen.append((q.shape, v.shape))
        return [4.0 * np.sin(3.0 * t)]

    run = sf.simulate(dragged(), t_end=0.1, u=law, dt=1e-3)
    wanted = sf.simulate(dragged(), t_end=0.1, u={"x": _DRIVE}, dt=1e-3)
    assert set(seen) == {((1,), (1,))} and run.z == pytest.approx(wanted.z, abs=1e-14)


def test_files_hold_them(tmp_path: Path) -> None:
    """Elements, states and what names them are read as they were written."""
    elements = (sf.LuGre(**_BRISTLES), sf.Hysteresis(80.0, "k", 3.0), sf.Hysteresis(8.0, 1.0))
    joint = sf.Joint("x-1", "prismatic", elements=elements)
    load = sf.Load(("y + `x-1.slip2`", "0", "0"))
    system = sf.System(
        "filed",
        (sf.RigidBody("b", joint, sf.Inertia(1.0), loads=(load,)),),
        (sf.Parameter("k", 1.0),),
        potentials=(sf.Potential("p", "k*y^2/2"),),
        states=(sf.ForceState("y", "k*(`dx-1` - y)"),),
    )
    path = tmp_path / "filed.yaml"
    sf.save(system, path)
    assert sf.load(path) == system
    path.write_text(path.read_text().replace("states:\n  y:", "states:\n  `y`: 1\n  y:"))
    with pytest.raises(sf.SymofrosError):
        sf.load(path)


def test_packages_of_c_carry_them(tmp_path: Path) -> None:
    """The program's own self-test, and its header's names; a model without states has the struct of before."""
    system = sf.System(
        "rubbing",
        (
            sf.RigidBody(
                "b", sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=(sf.LuGre(**_BRISTLES),)), sf.Inertia(1.0)
            ),
        ),
    )
    done = sf.export(system, "c", tmp_path / "c", method="rk4", dt=1e-4, start={"x": 0.1, "dx": 1.0, "x.bristle": 2e-4})
    assert "x.bristle" in done.notes[0]
    main = """#include <stdio.h>
#include "rubbing.h"
static double memory[1 << 16];
int main(void) {
    sym_instance *it = sym_instance_init(memory, sizeof memory, rubbing_plant());
    if (it == NULL || rubbing_selftest() > 1e-9 || sym_instance_advance(it, 0.5, 1e-4) != SYM_FINISHED) return 1;
    printf("%d %.17g %.17g %.17g\\n", (int)sym_nz(it->model), it->q[0], it->v[0], it->v[1]);
    return 0;
}
"""
    (tmp_path / "c" / "main.c").write_text(main)
    program = build(tmp_path / "c", "../moved", *sources(tmp_path / "c"))
    nz, *state = run_program(program, cwd=tmp_path).split()
    run = sf.simulate(sf.compile(system), [0.1], [1.0], 0.5, z0=[2e-4], dt=1e-4)
    assert nz == "1" and [float(x) for x in state] == pytest.approx(end_of(run), abs=1e-12)


@pytest.mark.parametrize(
    "ask",
    [
        lambda m: sf.rollout(m, None, None, np.zeros((3, 1)), dt=1e-3),
        lambda m: m.kernel("bias"),
        lambda m: m.bind("bias"),
        lambda m: m.evaluate("bias", q=[0.0], v=[0.0]),
        lambda m: m.vjp("forward_dynamics", q=[0.0], v=[0.0], u=[0.0], a_bar=[1.0]),
        lambda m: m.formulas(("x",)),
        lambda m: m.cuda(),
        lambda m: m.inverse_dynamics_second_derivatives([0.0], [0.0], [0.0]),
    ],
)
def test_models_without_states_say_so(ask: Any) -> None:
    with pytest.raises(sf.SymofrosError, match="has states of forces"):
        ask(dragged())


def test_rollouts_of_states_are_those_of_the_carried_model() -> None:
    """As the refusal says."""
    with pytest.raises(sf.SymofrosError, match=r"rollout takes none(.|\n)*sf\.rollout\(model\.carried"):
        sf.rollout(dragged(), [0.0], [0.0], np.ones((20, 1)), dt=1e-3)
    rolled = sf.rollout(dragged().carried, np.zeros(2), np.zeros(2), np.ones((20, 1)), dt=1e-3)
    run = sf.simulate(dragged(), t_end=0.02, dt=1e-3, u={"x": 1.0})
    np.testing.assert_allclose(rolled.v[-1], [*run.v[-1], *run.z[-1]], rtol=1e-12)


def test_models_without_states_refuse_them() -> None:
    model = block(sf.Damper(1.0))
    assert model.nz == 0 and model.carried is model and model.names.z == ()
    assert sf.simulate(model, t_end=0.01).z.shape == (11, 0)
    for ask in (
        lambda: model.forward_dynamics([0.0], [0.0], [0.0], z=[1.0]),
        lambda: model.potential_energy([0.0], z=[1.0]),
        lambda: sf.simulate(model, t_end=0.1, z0=[1.0]),
    ):
        with pytest.raises(sf.ShapeError, match="z has the wrong shape"):
            ask()


@pytest.mark.parametrize("k", [3.2, 4.0, 6.0])
def test_backlash_has_the_limit_cycle_of_its_describing_function(k: float) -> None:
    """A motor with PD on the load's side: amplitude and frequency of (12), (14), within the share of harmonics."""
    Jm, Jl, d, Kp, Kd, b = 0.02, 0.05, 0.4, 2.0, 0.05, 0.01
    slope = Jm * d**2 * Kp / ((d + Kd) * (d * Jm - Jl * Kd))
    w = np.sqrt(slope * (d + Kd) / (Jm * d))
    shares = np.linspace(1e-3, 0.9999, 200_000)  # b over the amplitude.
    falls = 1.0 - 2.0 / np.pi * (np.arcsin(shares) + shares * np.sqrt(1.0 - shares**2))
    amplitude = b / np.interp(-slope / k, -falls, shares)
    motor = sf.Joint("motor", "revolute", axis=(0, 0, 1), actuated=True)
    play = sf.Joint("play", "revolute", parent="rotor", axis=(0, 0, 1), elements=(sf.Stop(k, lower=-b, upper=b),))
    drag = f"-{d}*(dmotor + dplay)"
    system = sf.System(
        "gear",
        (
            sf.RigidBody("rotor", motor, sf.Inertia(1.0, (0, 0, 0), (Jm,) * 3)),
            sf.RigidBody("load", play, sf.Inertia(1.0, (0, 0, 0), (Jl,) * 3)),
        ),
        virtual_power=(sf.VirtualPower("drag", {"dmotor": drag, "dplay": drag}),),
    )
    law = {"motor": f"-{Kp}*(motor + play) - {Kd}*(dmotor + dplay)"}
    model = sf.compile(system)
    settled = sf.simulate(model, [amplitude, 0.0], t_end=300.0 / w, u=law, dt=0.01 / w, output=[300.0 / w])
    n = 4096
    run = sf.simulate(
        model, settled.q[-1], settled.v[-1], t_end=200.0 / w, u=law, dt=0.01 / w, output=np.arange(n) * 200.0 / w / n
    )
    window = np.hanning(n)
    spectrum = np.abs(np.fft.rfft(run["play"] * window))
    peak = int(spectrum.argmax())
    spread = np.arange(peak - 3, peak + 4)
    found = float((spread * spectrum[spread] ** 2).sum() / (spectrum[spread] ** 2).sum()) * 2.0 * np.pi / (200.0 / w)
    first = np.sqrt(2.0 * np.mean(run["play"] ** 2))  # The fundamental, but for harmonics.
    harmonics = np.sqrt(1.0 - (spectrum[spread] ** 2).sum() / (spectrum**2).sum())
    assert harmonics < 0.06
    assert abs(found / w - 1.0) < harmonics and abs(first / amplitude - 1.0) < harmonics


def test_runs_of_a_batch_keep_their_states_apart() -> None:
    """Outcomes, events and last states of each run are those of a run by itself."""
    joint = sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=(sf.Hysteresis(20.0, 1.0),), effort=("4*sin(3*t)",))
    system = sf.System("block", (sf.RigidBody("block", joint, sf.Inertia(1.5)),), gravity=(0, 0, 0))
    model, starts = sf.compile(system, sf.Options(backend="tape")), np.array([[0.0], [0.4], [-0.2]])
    given: dict[str, Any] = {"method": "rk4", "dt": 0.01, "events": {"back": sf.Event("dx", "falling")}}
    runs = sf.simulate_batch(model, starts, 0.5 * starts, 2.5, **given)
    for k, q in enumerate(starts):
        one = sf.simulate(model, q, 0.5 * q, 2.5, **given)
        assert runs.outcome((k,)).kind == one.outcome.kind == "finished"
        assert [x.t for x in runs.events((k,))] == pytest.approx([x.t for x in one.events], abs=1e-9)
        assert all(x.v.shape == (1,) for x in runs.events((k,)))
        np.testing.assert_allclose(runs.z_last[k], one.z[-1], atol=1e-12)
        np.testing.assert_allclose(runs[k].v[-1], one.v[-1], atol=1e-12)
    assert all(runs.events((k,)) for k in range(3)) and not runs.bendings((0,))
