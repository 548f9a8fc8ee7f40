"""Rods that stretch and shear: Timoshenko's closed forms, a spinning bar, large loads (docs/theory/rods.md)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import eigh, expm
from scipy.optimize import brentq, fsolve

import symofros as sf
from tests.mechanics.beams.rods import rod

L, EI, EA, GA, RHO_A, RHO_I = 1.3, 3.0, 40.0, 25.0, 2.0, 0.02
STATIC = ("generalized_force", "frame_pose", "frame_jacobian")


def model(*functions: str, joint: sf.Joint | None = None, bend: int = 0, **more: Any) -> sf.Model:
    given: dict[str, Any] = {"EI_z": EI, "EA": EA, "GA_y": GA, "rhoI_z": RHO_I, "rhoJ": 0.0}
    stated = rod((bend, 0, 0), joint, L, **(given | more))
    system = sf.System("s", (stated,), gravity=(0, 0, 0), parameters=(sf.Parameter("P", 0.0, constant=False),))
    return sf.compile(system, sf.Options(functions, ("tip",), backend="interpreter"))


def stiffness(m: sf.Model) -> np.ndarray:
    """Elastic forces are linear."""
    return -np.stack([m.generalized_force(unit, 0 * unit, ()) for unit in np.eye(m.nv)], axis=1)


def test_a_tip_load_deflects_as_timoshenkos_beam() -> None:
    m = model(*STATIC, bend=2, shear_y=1)
    across = m.frame_jacobian("tip", np.zeros(3))[1]
    deflection = across @ np.linalg.solve(stiffness(m), across)
    assert deflection == pytest.approx(L**3 / (3 * EI) + L / GA, rel=1e-12)


def frequency_equation(squared: float) -> float:
    """Zero at frequencies of the clamped and free Timoshenko beam, whose equations are solved by an exponential."""
    A = np.zeros((4, 4))  # Of deflection, turn, moment and shear force.
    A[0, 1], A[0, 3], A[1, 2] = 1.0, 1 / GA, 1 / EI
    A[2, 3], A[2, 1], A[3, 0] = -1.0, -squared * RHO_I, -squared * RHO_A
    return float(np.linalg.det(expm(A * L)[2:, 2:]))


def test_frequencies_match_timoshenko() -> None:
    m = model("mass_matrix", "generalized_force", bend=10, shear_y=10, rotary_inertia=True)
    squares = eigh(stiffness(m), m.mass_matrix(np.zeros(20)), eigvals_only=True)
    for square in squares[:2]:
        exact = brentq(frequency_equation, 0.99 * square, 1.01 * square, xtol=1e-12, rtol=1e-14)
        assert np.sqrt(square / exact) == pytest.approx(1.0, abs=1e-8)


def test_a_spinning_bar_stretches_as_it_does_exactly() -> None:
    """EA r'' = -rhoA Omega^2 r along the bar, so r = sin(k x)/(k cos(k L)) at any strain."""
    hub = sf.Joint("hub", "revolute")
    m = model("bias", "generalized_force", "frame_pose", joint=hub, stretch=7)
    spin = 1.2 / L * np.sqrt(EA / RHO_A)
    v = np.array([spin, *(0.0,) * 7])
    # Both forces are linear in the stretch.
    still = np.zeros(8)
    force = m.bias(still, v)[1:]
    K = np.stack([m.bias(q, v) - m.generalized_force(q, 0 * q, ()) for q in np.eye(8)[1:]], axis=1)[1:] - force[:, None]
    q = np.concatenate([[0.0], -np.linalg.solve(K, force)])
    k = spin * np.sqrt(RHO_A / EA)
    assert m.frame_pose("tip", q)[0][0] == pytest.approx(np.tan(k * L) / k, rel=1e-8)


def shooting(load: float) -> np.ndarray:
    """Tip of the rod under a force along y: turn, place, of sections that stretch and shear by the force there."""

    def ends(tip: np.ndarray) -> np.ndarray:
        def slope(_: float, y: np.ndarray) -> list[float]:
            c, s = np.cos(y[0]), np.sin(y[0])
            stretch, shear = 1 + load * s / EA, load * c / GA
            return [load * (tip[0] - y[1]) / EI, c * stretch - s * shear, s * stretch + c * shear]

        run = solve_ivp(slope, (0, L), [0.0, 0.0, 0.0], "DOP853", rtol=1e-12, atol=1e-13)
        return run.y[1:, -1]

    return ends(fsolve(lambda tip: ends(tip) - tip, [0.5 * L, 0.8 * L], xtol=1e-13))


def test_a_large_load_bends_stretches_and_shears_as_by_shooting() -> None:
    load = sf.BeamLoad((0.0, sf.formula("P", "load"), 0.0), at=1.0, axes="world")
    m = model(*STATIC, bend=5, stretch=5, shear_y=5, loads=(load,)).with_parameters(P=8.0)
    q, width = np.zeros(m.nq), 1e-6 * np.eye(m.nq)
    for _ in range(20):
        forces = m.generalized_force(np.concatenate([q + width, q - width, [q]]), np.zeros((2 * m.nq + 1, m.nq)), ())
        step = np.linalg.solve((forces[: m.nq] - forces[m.nq : -1]).T / 2e-6, forces[-1])
        q = q - step * min(1.0, 1.0 / np.abs(step).max())
    assert np.abs(step).max() < 1e-9
    # The largest turn is 1.1 rad, the tip's sections are 0.3 off the axis.
    assert m.frame_pose("tip", q)[0][:2] == pytest.approx(shooting(8.0), abs=4e-6 * L)


def test_stiffnesses_of_stretch_and_shear_are_needed_and_come_from_sections() -> None:
    for counts, label in (({"stretch": 1}, "EA"), ({"shear_z": 2}, "GA_z")):
        with pytest.raises(sf.DescriptionError, match=f"{label} = 0"):
            sf.compile(sf.System("s", (rod((1, 0, 0), **counts),)))
    with pytest.raises(sf.DescriptionError, match="theory 'second_order'"):
        rod((1, 0, 0), theory="second_order", stretch=1)
    section = sf.sections.rectangle(sf.sections.Material(70e9, 26e9, 2700.0), 0.02, 0.01)
    beam = sf.Beam("b", sf.Joint("root", "fixed"), 1.0, theory="strain", **section.beam_properties("strain"))
    assert (beam.EA, beam.GA_y) == (section.EA, section.GA_y)
