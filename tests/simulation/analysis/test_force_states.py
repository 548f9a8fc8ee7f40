"""States of forces at rest: equilibria, modes, linear models against closed forms, differences and SciPy.

docs/theory/states.md, sections 6 and 7.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import symofros as sf
from tests.models import interpreted
from tests.simulation.beam_models import cantilever_system

_MASS, _S0, _S1, _S2, _F_C, _F_S = 1.5, 3e3, 20.0, 0.3, 2.0, 3.0
_BRISTLES = sf.LuGre(_F_C, _S0, _S1, static=_F_S, stribeck_velocity=0.05, viscous=_S2)
_MANY = "may rest at other values"


@cache
def block(*elements: Any, states: tuple[sf.ForceState, ...] = (), **fields: Any) -> sf.Model:
    """A block on a level slide, with a force as input."""
    joint = sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=elements, actuated=True)
    bodies = (sf.RigidBody("block", joint, sf.Inertia(_MASS)),)
    return interpreted(sf.System("block", bodies, states=states, **fields))


# Equilibria.


def test_the_least_change_shares_a_load_by_stiffness() -> None:
    """k x + s0 z = F holds on a line; its point nearest to the guess, (23)."""
    k, load, guess = 900.0, 2.5, np.array([1e-4, -3e-4])
    model = block(_BRISTLES, sf.Spring(k))
    rest = sf.equilibrium(model, guess[:1], u=[load], z=guess[1:])
    stiffness = np.array([k, _S0])
    wanted = guess + stiffness * (load - stiffness @ guess) / (stiffness @ stiffness)
    assert np.concatenate([rest.q, rest.z]) == pytest.approx(wanted, rel=1e-12)
    (note,) = rest.notes
    assert "'x.bristle'" in note and _MANY in note and rest.lam.shape == (0,)
    assert model.forward_dynamics(rest.q, rest.v, rest.u, z=rest.z) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("element", [_BRISTLES, sf.Hysteresis(_S0, _F_S, 3.0)])
def test_yielding_elements_stay_as_guessed_and_the_block_moves(element: Any) -> None:
    """Beyond 3 N nothing holds it at the guess: the spring takes all. Short of it, the element does."""
    model = block(element, sf.Spring(30.0))
    held, moved = sf.equilibrium(model, u=[0.999 * _F_S]), sf.equilibrium(model, u=[1.01 * _F_S])
    assert held.z == pytest.approx(0.999 * _F_S / _S0, rel=1e-3) and len(held.notes) == 1
    assert moved.z == 0.0 and moved.q == pytest.approx(1.01 * _F_S / 30.0, rel=1e-12)
    assert "would yield" in moved.notes[0] and _MANY in moved.notes[1]


def test_a_load_that_nothing_holds_is_refused_with_what_yields() -> None:
    with pytest.raises(sf.EquilibriumError, match=r"'x'; states of forces 'x\.bristle' would yield") as refusal:
        sf.equilibrium(block(_BRISTLES), u=[1.01 * _F_S])
    assert _MANY not in str(refusal.value)


def test_a_rest_stays_where_it_is_in_an_independent_integration() -> None:
    """LuGre by SciPy from the rest found, at 0.9 of what bristles hold: no creep in 10 s."""
    model, load = block(_BRISTLES, sf.Spring(30.0)), 0.9 * _F_S
    rest = sf.equilibrium(model, u=[load])

    def rates(t: float, y: np.ndarray) -> list[float]:
        x, v, z = y
        rate = v - _S0 * abs(v) * z / (_F_C + (_F_S - _F_C) * np.exp(-((v / 0.05) ** 2)))
        return [v, (load - 30.0 * x - _S0 * z - _S1 * rate - _S2 * v) / _MASS, rate]

    start = [rest.q[0], 0.0, rest.z[0]]
    end = solve_ivp(rates, (0.0, 10.0), start, method="DOP853", rtol=1e-10, atol=1e-14).y[:, -1]
    assert end == pytest.approx(start, abs=1e-10)


def test_states_that_relax_have_one_place() -> None:
    """y' = 40 (2 x - y) - 5 y^3, the force 30 x + 8 y: against a root found apart; no note, whatever the guess."""
    model = block(
        sf.Spring(30.0),
        states=(sf.ForceState("y", "40*(2*x - y) - 5*y^3"),),
        potentials=(sf.Potential("p", "8*y*x"),),
    )
    y = brentq(lambda y: 30.0 * (y + y**3 / 8.0) / 2.0 + 8.0 * y - 6.0, 0.0, 2.0, xtol=1e-15)
    for guess in (0.0, 1.0, -2.0):
        rest = sf.equilibrium(model, [guess], u=[6.0], z={"y": 1.0})
        assert np.concatenate([rest.q, rest.z]) == pytest.approx([(y + y**3 / 8.0) / 2.0, y], rel=1e-9)
        assert not rest.notes and rest.residual < 1e-11


def test_states_in_units_of_their_own() -> None:
    """A pressure of 1e7 and its valve, a counter of heat beside: found from zero to the last digits."""
    model = block(
        sf.Spring(1e5),
        states=(sf.ForceState("p", "1e9*(1e-3*(1e7 - p) - x*1e2)"), sf.ForceState("heat", "abs(dx)")),
        potentials=(sf.Potential("piston", "-1e-4*p*x"),),
    )
    rest = sf.equilibrium(model)
    x = 1e3 / (1e5 + 10.0)  # 1e5 x = 1e-4 p, p = 1e7 - 1e5 x.
    assert rest.q == pytest.approx(x, rel=1e-9) and rest.z == pytest.approx([1e7 - 1e5 * x, 0.0], rel=1e-9)
    (note,) = rest.notes
    assert "'heat'" in note and "'p'" not in note


@pytest.mark.parametrize("guess", [0.0, 1e-12, -1.0])
def test_a_state_that_takes_years(guess: float) -> None:
    """y' = 1e-8 (5.1 - y + x - y^3) beside a stiff spring: as exact as others, from its rest, too."""
    states, pull = (sf.ForceState("y", "1e-8*(5.1 - y + x - y^3)"),), (sf.VirtualPower("pull", {"dx": "1e7*y"}),)
    y = brentq(lambda y: 5.1 - 0.9 * y - y**3, 0.0, 3.0, xtol=1e-15)
    rest = sf.equilibrium(block(sf.Spring(1e8), states=states, virtual_power=pull), z=[y + guess])
    assert [*rest.q, *rest.z] == pytest.approx([0.1 * y, y], rel=1e-10) and not rest.notes


@pytest.mark.parametrize("change", [-1e-16, 0.0, 2e-16])
def test_a_rest_but_for_rounding_is_taken(change: float) -> None:
    """Nothing on the way says what a small rate is, but what the state brings by itself."""
    model = block(sf.Spring(1.0), states=(sf.ForceState("y", "1e-8*(5.1 - y - y^3)"),))
    y = brentq(lambda y: 5.1 - y - y**3, 0.0, 3.0, xtol=1e-15)
    rest = sf.equilibrium(model, z=[y * (1.0 + change)])
    assert rest.z == pytest.approx(y, rel=1e-15) and rest.iterations == 0


def test_one_yields_and_the_other_holds() -> None:
    """Of two blocks under loads the one is pulled to where its spring holds it, the other stays on its bristles."""
    joints = [sf.Joint(name, "prismatic", axis=(1, 0, 0), elements=(_BRISTLES,), actuated=True) for name in "xy"]
    joints[0] = replace(joints[0], elements=(_BRISTLES, sf.Spring(30.0)))
    bodies = tuple(sf.RigidBody(f"b{joint.name}", joint, sf.Inertia(1.0)) for joint in joints)
    rest = sf.equilibrium(interpreted(sf.System("two", bodies)), u=[6.0, 1.5])
    assert [*rest.q, *rest.z] == pytest.approx([0.2, 0.0, 0.0, 1.5 / _S0], rel=1e-12)
    yields, many = rest.notes
    assert "'x.bristle'" in yields and "'y.bristle'" not in yields and "'y.bristle'" in many


def test_a_steady_motion_has_the_curve_of_stribeck_and_its_bristles() -> None:
    """Of a held speed: effort g + s2 v, z = g/s0; nothing rests elsewhere."""
    model, v = block(_BRISTLES), 0.03
    rest = sf.equilibrium(model, v=[v], held=["x"])
    g = _F_C + (_F_S - _F_C) * np.exp(-((v / 0.05) ** 2))
    assert rest.efforts["x"] == pytest.approx(g + _S2 * v, rel=1e-10)
    assert rest.z == pytest.approx(g / _S0, rel=1e-10) and not rest.notes
    assert rest.inputs is not None and rest.inputs["x"] == pytest.approx(rest.efforts["x"], rel=1e-10)


def test_a_rest_far_from_the_guess_is_found_by_relaxation() -> None:
    """x^3 - 2 x + 2 has its one zero at -1.769 and a minimum at 0.816, where Newton's method stalls; y follows 3 x."""
    model = block(
        states=(sf.ForceState("y", "2*(3*x - y)"),),
        virtual_power=(sf.VirtualPower("p", {"dx": "2*x - x^3 - 2 + y - 3*x"}),),
    )
    rest = sf.equilibrium(model, [1.0], z=[3.5])
    root = np.roots([1.0, 0.0, -2.0, 2.0])
    assert [*rest.q, *rest.z] == pytest.approx([float(root[np.isreal(root)].real[0]) * f for f in (1.0, 3.0)], rel=1e-9)


@pytest.mark.parametrize("share", [1.1, 0.9])
def test_a_rest_is_judged_by_forces_whose_states_follow(share: float) -> None:
    """An upright rod leans on a force that follows it late, of more than m g L a radian or of less: (7b), (22a)."""
    moment, J = 9.81 * 0.5, 0.02 + 0.5**2
    rod = sf.RigidBody("rod", sf.Joint("q", "revolute", axis=(0, 1, 0)), sf.Inertia(1.0, (0.5, 0, 0), (0, 0.02, 0.02)))
    state = sf.ForceState("y", f"40*(q + {np.pi / 2} - y)")
    holds = sf.VirtualPower("holds", {"dq": f"-{share * moment}*y"})
    model = interpreted(sf.System("rod", (rod,), states=(state,), virtual_power=(holds,)))
    rest = sf.equilibrium(model, [-np.pi / 2 + 1e-3])
    assert rest.q == pytest.approx(-np.pi / 2, abs=1e-9) and rest.z == pytest.approx(0.0, abs=1e-9)
    leaves = f"'q' leaves it at {np.sqrt(moment * (1.0 - share) / J):.3g} 1/s" if share < 1.0 else ""
    assert [leaves in note for note in rest.notes] == [True] * (share < 1.0), rest.notes


# Modes and linear models.


def test_bristles_that_stick_are_a_spring_and_a_place_of_rest() -> None:
    """About z = 0: m s^2 + (s1 + s2) s + k + s0 = 0, and s = 0 once, of which k x + s0 z = 0; silent."""
    k = 50.0
    found = sf.modes(block(_BRISTLES, sf.Spring(k)), [0.0], z=[0.0])
    roots = np.roots([_MASS, _S1 + _S2, k + _S0])
    assert found.eigenvalues == pytest.approx([0.0, roots[roots.imag > 0.0][0]], rel=1e-10)
    assert found.shapes == pytest.approx(np.ones((1, 2))) and found.z_shapes[0, 0] == pytest.approx(-k / _S0)
    assert found.z_shapes[0, 1] == pytest.approx(1.0) and not found.notes


def test_a_kink_of_rates_is_noted_where_bristles_are_bent() -> None:
    """Slopes of the rate of 1 -+ s0 z/F_s by the speed, (24), and so of the force: s1 times that, and s2."""
    found = sf.modes(block(_BRISTLES), [0.0], u=[1.5], z=[0.5 * _F_S / _S0])
    (note,) = found.notes
    assert note.startswith("forces on 'x' and rates of states of forces 'x.bristle' have a kink here (slopes ")
    assert f"(slopes {-1.5 * _S1 - _S2:.3g} and {-0.5 * _S1 - _S2:.3g} by the speed of 'x')" in note


@pytest.mark.parametrize(
    ("force", "noted"),
    [
        ("-400*max(0, x)", "slopes -0 and -400 by 'x'"),  # A rope that goes slack.
        ("-400*x - 30*abs(dx)", "slopes 30 and -30 by the speed of 'x'"),
        ("-400*x - 30*abs(dx)*dx + 5*cos(x) - 7*dx^2 - 9e4*max(0, x)^1.5", ""),
        ("-400*max(0, x - 1e-3)", ""),
    ],
)
def test_a_kink_of_forces_is_noted_and_a_curve_is_not(force: str, noted: str) -> None:
    notes = [
        note
        for note in sf.modes(block(virtual_power=(sf.VirtualPower("rope", {"dx": force}),)), [0.0]).notes
        if "kink" in note
    ]
    assert [noted in note and "forces on 'x'" in note for note in notes] == [True] * bool(noted)
    assert all(note.endswith(": modes are those of the mean slope") for note in notes)


def test_modes_of_states_alone_have_shapes_of_their_own() -> None:
    """A spring's vibration, two decays that move nothing, a state without a rate of its own."""
    states = (sf.ForceState("y", "2*x - y"), sf.ForceState("w", "dx + 4*y - 3*w"), sf.ForceState("n", "x"))
    found = sf.modes(block(sf.Spring(30.0), states=states), [0.0])
    assert found.eigenvalues == pytest.approx([0.0, -1.0, -3.0, 1j * np.sqrt(20.0)], abs=1e-12)
    assert found.shapes == pytest.approx(np.array([[0.0, 0.0, 0.0, 1.0]]), abs=1e-15)
    i = found.eigenvalues[3]
    y = 2.0 / (i + 1.0)
    wanted = np.array([[0, 0.5, 0, y], [0, 1, 1, (i + 4.0 * y) / (i + 3.0)], [1, 0, 0, 1.0 / i]])
    assert found.z_shapes == pytest.approx(wanted, abs=1e-12)


def test_free_vibration_by_scipy_is_the_sum_of_its_modes() -> None:
    """A small motion of spring, bristles at z = 0 and a state that relaxes, over 0.3 s."""
    model = block(_BRISTLES, sf.Spring(50.0), states=(sf.ForceState("y", "8*(x - y)"),), virtual_power=_pull(9.0))
    A, _ = model.linearize([0.0], [0.0], [0.0])
    size = 1e-8

    def rates(t: float, state: np.ndarray) -> list[float]:
        x, v, y, z = state
        rate = v - _S0 * abs(v) * z / (_F_C + (_F_S - _F_C) * np.exp(-((v / 0.05) ** 2)))
        return [v, (-50.0 * x - 9.0 * y - _S0 * z - _S1 * rate - _S2 * v) / _MASS, 8.0 * (x - y), rate]

    start = size * np.array([1.0, 5.0, -2.0, 0.3])
    end = solve_ivp(rates, (0.0, 0.3), start, method="DOP853", rtol=1e-11, atol=1e-18).y[:, -1]
    s, X = np.linalg.eig(A)
    assert (X * np.exp(0.3 * s)) @ np.linalg.solve(X, start) == pytest.approx(end, abs=1e-5 * size)
    found = sf.modes(model, [0.0])
    np.testing.assert_allclose(sorted(found.eigenvalues, key=abs), sorted(s[s.imag >= 0.0], key=abs), atol=1e-9)


def _pull(k: float) -> tuple[sf.VirtualPower, ...]:
    return (sf.VirtualPower("pull", {"dx": f"-{k}*y"}),)


def test_constraints_do_not_bind_states() -> None:
    """Two blocks, y = 2 x, a spring on x and a state that pulls y: eigenvalues of the one freedom, by hand."""
    joints = [sf.Joint(name, "prismatic", axis=(1, 0, 0), actuated=name == "x") for name in "xy"]
    joints[0] = sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=(sf.Spring(70.0),), actuated=True)
    system = sf.System(
        "geared",
        [sf.RigidBody(f"b{j.name}", j, sf.Inertia(m)) for j, m in zip(joints, (1.5, 0.4), strict=True)],
        constraints=(sf.Coupling("gear", "y - 2*x"),),
        states=(sf.ForceState("s", "5*dy - 3*s"),),
        virtual_power=(sf.VirtualPower("pull", {"dy": "-4*s"}),),
    )
    model = interpreted(system)
    M = 1.5 + 4.0 * 0.4
    expected = np.roots([M, 3.0 * M, 70.0 + 2.0 * 4.0 * 5.0 * 2.0, 3.0 * 70.0])
    found = sf.modes(model, [0.0, 0.0])
    kept = expected[expected.imag >= 0.0]
    np.testing.assert_allclose(found.eigenvalues, kept[np.argsort(abs(kept))], rtol=1e-9)
    space = sf.state_space(model, [0.0, 0.0], outputs=("z", "lam", "q"))
    assert space.basis.shape == (5, 3) and space.C.shape == (4, 3)
    poles = np.linalg.eigvals(space.A)
    np.testing.assert_allclose(np.sort_complex(poles), np.sort_complex(expected), rtol=1e-9)
    s = 2.0j  # From the force to the state, and to y.
    transfer = space.C @ np.linalg.solve(s * np.eye(3) - space.A, space.B) + space.D
    y_of_u = 2.0 * (s + 3.0) / np.polyval([M, 3.0 * M, 150.0, 210.0], s)
    assert transfer[[0, 3], 0] == pytest.approx([5.0 * s / (s + 3.0) * y_of_u, y_of_u], rel=1e-9)
    rest = sf.equilibrium(model, u=[7.0])
    assert rest.q == pytest.approx([0.1, 0.2]) and rest.z == pytest.approx(0.0, abs=1e-12) and not rest.notes


def test_outputs_of_linear_models_are_those_of_differences() -> None:
    """z, accelerations and a frame's acceleration of a block with bristles, row by row."""
    joint = sf.Joint("q", "revolute", axis=(0, 1, 0), elements=(_BRISTLES,), actuated=True)
    frames = (sf.Frame("tip", (0.6, 0, 0)),)
    body = sf.RigidBody("b", joint, sf.Inertia(1.0, (0.3, 0, 0.1), (0.1,) * 3), frames)
    model = interpreted(sf.System("s", (body,), states=(sf.ForceState("y", "sin(q) - y*dq"),), virtual_power=_turn()))
    at = np.array([0.3, 0.4, 0.7, 2e-4])
    outputs = ("a", ("frame_acceleration", "b.tip"), "z", "v", "q")
    found = model.linearize(at[:1], at[1:2], [0.5], outputs=outputs, z=at[2:])

    def values(x: np.ndarray) -> np.ndarray:
        q, v, z = x[:1], x[1:2], x[2:]
        a = model.forward_dynamics(q, v, [0.5], z=z)
        return np.concatenate([a, model.frame_acceleration("b.tip", q, v, a), z, v, q])

    step = 1e-7
    wanted = np.transpose([(values(at + d) - values(at - d)) / (2.0 * step) for d in step * np.eye(4)])
    assert found.C == pytest.approx(wanted, rel=1e-6, abs=1e-6) and found.D[0] > 0.0
    with pytest.raises(sf.UnknownNameError, match="no such output"):
        block().linearize([0.0], [0.0], [0.0], outputs=("z",))


def _turn() -> tuple[sf.VirtualPower, ...]:
    return (sf.VirtualPower("turn", {"dq": "-2*y"}),)


def test_efforts_overcome_forces_of_states() -> None:
    """u = m a + s0 z + s1 z' + s2 v, by the states given; of the neutral ones without the first term."""
    model, a, v, z = block(_BRISTLES), 0.7, 0.03, 4e-4
    rate = model.state_rates([0.0], [v], [0.0], z=[z])[0]
    found = sf.actuator_efforts(model, [0.0], [v], [a], z=[z])
    assert found.efforts == pytest.approx(_MASS * a + _S0 * z + _S1 * rate + _S2 * v, rel=1e-12)
    neutral = sf.actuator_efforts(model, [0.0], [v], [a])
    assert neutral.efforts == pytest.approx(_MASS * a + (_S1 + _S2) * v, rel=1e-12)


def test_beams_are_judged_as_without_states() -> None:
    """Bending, amplified by axial load, notes, modes and efforts of a cantilever with an idle state."""
    system, state = cantilever_system(), sf.ForceState("y", "1 - y")
    plain, stated = interpreted(system), interpreted(replace(system, states=(state,)))
    for P, F in ((2.0, 0.1), (2.6, 0.0)):
        loads = {"P": P, "F": F}
        a, b = (sf.equilibrium(m.with_parameters(**loads), beam_limit=np.inf) for m in (plain, stated))
        assert [x.error for x in b.bendings] == pytest.approx([x.error for x in a.bendings], rel=1e-6)
        assert b.notes == a.notes and b.z == pytest.approx([1.0])
        s, t = (sf.modes(m.with_parameters(**loads), a.q, beam_limit=np.inf) for m in (plain, stated))
        np.testing.assert_allclose(np.sort_complex(t.eigenvalues), np.sort_complex([*s.eigenvalues, -1.0]), rtol=1e-6)
        assert [x.error for x in t.bendings] == pytest.approx([x.error for x in s.bendings], rel=1e-6)
        rest = plain.nv * (0.0,)
        e, f = (
            sf.actuator_efforts(m.with_parameters(**loads), a.q, rest, rest, plain.names.v, beam_limit=np.inf)
            for m in (plain, stated)
        )
        assert [x.error for x in f.bendings] == pytest.approx([x.error for x in e.bendings], rel=1e-6)
