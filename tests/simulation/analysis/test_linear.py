"""Linearisation against central differences and Pinocchio, equilibria and modes against closed forms."""

from __future__ import annotations

import re

import numpy as np
import pytest

import symofros as sf
from tests.models import GUESSES
from tests.models import compiled as model


def state(name: str, seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    m, rng = model(name), np.random.default_rng(seed)
    q, v = m.random_state(rng)
    return q, v, rng.normal(size=m.nu)


def test_batches_equal_single_states() -> None:
    m = model("rx90")
    many = [state("rx90", seed) for seed in range(4)]
    q, v, u = (np.array(x) for x in zip(*many, strict=True))
    A, B = m.linearize(q, v, u)
    for i, one in enumerate(many):
        A1, B1 = m.linearize(*one)
        assert np.allclose(A[i], A1, rtol=1e-12, atol=1e-12) and np.allclose(B[i], B1, rtol=1e-12, atol=1e-12)


class TestEquilibrium:
    def test_a_pendulum_hangs_at_equilibrium(self) -> None:
        found = sf.equilibrium(model("flexible_pendulum"), [1.2, 0, 0, 0])
        assert found.q[0] == pytest.approx(np.pi / 2, abs=1e-10) and np.abs(found.q[1:]).max() < 1e-10

    def test_a_loop_hangs_and_its_multipliers_carry_it(self) -> None:
        m = model("four_bar")
        found = sf.equilibrium(m, [-1.2, 1.2, -1.2])
        assert np.abs(m.constraint(found.q)).max() < 1e-11
        # By the parallelogram's symmetry each side carries half of the coupler's weight.
        assert np.abs(found.lam).max() == pytest.approx(0.5 * 9.81, rel=1e-8)

    def test_inputs_replace_the_effort_on_held_coordinates(self) -> None:
        m = model("puma560")
        q = np.linspace(1.7, -1.7, m.nv)
        rest = sf.equilibrium(m, q, held=m.names.v)
        assert rest.inputs is not None and tuple(rest.inputs) == m.names.u
        assert rest.efforts == dict(zip(m.names.v, rest.effort.tolist(), strict=True))
        free = sf.equilibrium(m, q, u=rest.inputs)
        assert free.iterations == 0 and free.inputs == rest.inputs and not free.efforts

    def test_a_missing_equilibrium_reports_the_imbalance(self) -> None:
        with pytest.raises(sf.EquilibriumError, match="imbalance of .* at 'x'"):
            sf.equilibrium(model("cart_pole"), [0, 1.0], u=[1.0])


class TestModes:
    def test_modes_in_words(self) -> None:
        """What topples has no frequency in Hz, though |s| is a number as of what swings; a free slide is rigid."""
        joint = sf.Joint("q", "revolute", axis=(0, 1, 0), elements=(sf.Damper("c"),))
        bar = sf.RigidBody("bar", joint, sf.Inertia(1.0, (0, 0, -1.0)))
        cart = sf.RigidBody("cart", sf.Joint("x", "prismatic", axis=(1, 0, 0)), sf.Inertia(1.0))
        model = sf.compile(sf.System("two", (bar, cart), (sf.Parameter("c", 0.0),)))
        w = np.sqrt(9.81)
        swings, topples = (str(sf.modes(model, {"q": q}, par=[c])).splitlines() for q, c in ((0.0, 0.0), (np.pi, 0.2)))
        assert swings == ["mode 0: rigid motion", f"mode 1: oscillates at {w:.6g} rad/s = {w / 2 / np.pi:.6g} Hz"]
        slow, fast = (np.hypot(w, 0.1) + sign * 0.1 for sign in (-1, 1))
        assert sorted(line[8:] for line in topples[1:]) == [f"decays at {fast:.6g} 1/s", f"grows at {slow:.6g} 1/s"]
        damped = str(sf.modes(model, [0.0, 0.0], par=[0.2])).splitlines()[1]
        assert damped.endswith(f"Hz, damping {0.1 / w:.4g}")

    @pytest.mark.parametrize(("eta", "first"), [(0.0, 3.5160152685), (6.0, 4.2632254202)])
    def test_spinning_beam_frequency_matches_the_benchmark(self, eta: float, first: float) -> None:
        """First frequency in the plane of rotation, of the rotating cantilever (benchmark A1, hub ratio 0)."""
        beam = sf.Beam(
            "b", sf.Joint("hub", "revolute", prescribed=True), 1.0, 1.0, EI_z=1.0, bend_y=6, family="legendre"
        )
        m = sf.compile(sf.System("s", [beam], gravity=(0, 0, 0)))
        u = [0.0, eta, 0.0]
        steady = sf.equilibrium(m, u=u)
        found = sf.modes(m, steady.q, u=u)
        assert found.frequencies[0] == pytest.approx(first, rel=1e-6) and abs(found.damping[0]) < 1e-9

    def test_a_damped_oscillator_has_its_known_modes(self) -> None:
        slide = sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=(sf.Spring(50.0), sf.Damper(2.0)))
        m = sf.compile(sf.System("s", [sf.RigidBody("b", slide, sf.Inertia(2.0))]))
        found = sf.modes(m, [0.0])
        assert found.frequencies == pytest.approx([5.0]) and found.damping == pytest.approx([0.1])

    @pytest.mark.parametrize(("excess", "stable"), [(-1e-3, False), (1e-3, True)])
    def test_critical_spin_of_a_rolling_disc_matches_theory(self, excess: float, stable: bool) -> None:
        """A thin disc stays upright above w^2 = I_d m g r / (I_a (I_a + m r^2)) (Appell; Neimark & Fufaev)."""
        critical = np.sqrt(0.25 * 9.81 / (0.5 * 1.5))
        turn, names = sf.Rotation.rpy("lean", 0, "yaw"), ("x", "y", "z", "yaw", "lean")
        pose = sf.Joint("pose", "general", coordinates=names, moving_position=("x", "y", "z"), moving_rotation=turn)
        spin = sf.Joint("spin", "revolute", "fork", rotation=sf.Rotation.rpy("pi/2", 0, 0))
        disc = sf.RigidBody("disc", spin, sf.Inertia(1.0, (0, 0, 0), (0.25, 0.25, 0.5)))
        rolling = sf.Rolling("contact", ("disc", None), 1.0)
        m = sf.compile(sf.System("s", [sf.RigidBody("fork", pose), disc], constraints=[rolling]))
        w = critical * (1 + excess)
        at = sf.assemble(m, [0, 0, 1, 0, 0, 0], [w, 0, 0, 0, 0, w], held=["spin"])
        found = sf.modes(m, at.q, at.v)
        assert (found.eigenvalues.real.max() < 1e-2) == stable and not found.notes

    # Notes on the beams, which these states have beside.
    OF_BEAMS = re.compile("theory errs|too few shape functions")
    NO_EQUILIBRIUM = "the state is neither an equilibrium nor a steady motion"

    @pytest.mark.parametrize("name", ["double_pendulum", "rx90", "four_bar", "heavy_top", "flexible_pendulum"])
    def test_states_that_do_not_balance_are_noted_and_rests_are_not(self, name: str) -> None:
        """At a rest to four digits the modes are right to four, too."""
        m = model(name)

        def moved(by: float) -> np.ndarray:
            change = by * np.linspace(1.0, 0.1, m.nv) ** 3
            return sf.assemble(m, rest.q + change).q if m.nc else m.integrate(rest.q, change)

        rest = sf.equilibrium(m, GUESSES.get(name, m.integrate(m.neutral(), np.full(m.nv, 0.1))))
        for near in (rest.q, moved(1e-5)):
            assert all(self.OF_BEAMS.search(note) for note in sf.modes(m, near).notes)
        far = moved(0.6)
        (note,) = (one for one in sf.modes(m, far, beam_limit=np.inf).notes if not self.OF_BEAMS.search(one))
        a = m.forward_dynamics(far, np.zeros(m.nv), np.zeros(m.nu))
        k = int(np.abs(a).argmax())
        assert self.NO_EQUILIBRIUM in note and f"'{m.names.v[k]}' accelerates by {a[k]:.3g}," in note

    def test_states_that_move_on_to_the_same_equations_are_not_noted(self) -> None:
        """A fall, and a cart under a constant push with its pendulum at the angle that stays."""
        body = sf.RigidBody("body", sf.Joint("free", "free"), sf.Inertia(2.0, (0.1, 0.2, 0.3), (1.0, 2.0, 2.5)))
        falling = sf.compile(sf.System("falling", (body,)))
        q, _ = falling.random_state(np.random.default_rng(0))
        assert not sf.modes(falling, q).notes
        cart = sf.RigidBody("cart", sf.Joint("x", "prismatic", axis=(1, 0, 0), actuated=True), sf.Inertia(2.0))
        rod = sf.Inertia(1.0, (0, 0, -0.5), (0.1, 0.1, 0.1))
        pendulum = sf.RigidBody("rod", sf.Joint("q", "revolute", "cart", axis=(0, 1, 0)), rod)
        m = sf.compile(sf.System("pushed", (cart, pendulum)))
        for angle, noted in ((np.arctan2(3.0, 9.81), False), (0.0, True)):
            a = m.forward_dynamics([0.0, angle], [0.0, 0.0], [9.0])
            assert (abs(a[1]) > 1e-9) == noted and abs(a[0]) > 2.5
            assert bool(sf.modes(m, [0.0, angle], u=[9.0]).notes) == noted

    def test_a_spin_that_changes_within_a_period_is_noted(self) -> None:
        """The stiffness of a turning blade follows the speed."""
        hub = sf.Joint("hub", "revolute", actuated=True)
        beam = sf.Beam("b", hub, 1.0, 1.0, EI_z=1.0, bend_y=2, family="legendre")
        m = sf.compile(sf.System("blade", [beam], gravity=(0, 0, 0)))
        q, v = np.zeros(3), np.array([2.0, 0.0, 0.0])
        assert all(self.OF_BEAMS.search(note) for note in sf.modes(m, q, v).notes)
        assert self.NO_EQUILIBRIUM in sf.modes(m, q, v, [1.0]).notes[0]
