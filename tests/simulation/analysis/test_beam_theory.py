"""Equilibria say how far second-order theory of beams holds (docs/theory/beams.md, section 6)."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import symofros as sf
from tests.simulation.beam_models import cantilever, critical_load
from validation.accuracy.statics.elastica import exact as elastica


def error_of(**par: float) -> float:
    """Estimated error of the beam's equilibrium."""
    (bending,) = sf.equilibrium(cantilever().with_parameters(**par), beam_limit=math.inf).bendings
    return bending.error


@pytest.mark.parametrize("load", [0.3, 1.0, 2.2])
def test_the_error_under_a_force_at_the_tip_is_that_against_the_elastica(load: float) -> None:
    loaded = cantilever().with_parameters(F=load)
    rest = sf.equilibrium(loaded, beam_limit=math.inf)
    exact = np.array([-elastica(load)[1], elastica(load)[0]])
    p, _ = loaded.frame_pose("tip", rest.q)
    error = float(np.linalg.norm(p[:2] - (1.0, 0.0) - exact) / np.linalg.norm(exact))
    assert 0.01 < error < 0.5
    assert rest.bendings[0].error == pytest.approx(error, rel=0.1)


@settings(max_examples=10)
@given(st.floats(-6, 6), st.floats(-9, 9), st.floats(0.01, 3.0))
def test_the_estimate_does_not_change_with_length_and_stiffness(length: float, stiffness: float, load: float) -> None:
    L, EI = 10.0**length, 10.0**stiffness
    assert error_of(L=L, EI=EI, F=load * EI / L**2) == pytest.approx(error_of(F=load), rel=1e-9)


def test_compression_amplifies_the_error_and_tension_reduces_it() -> None:
    pulled, free, pushed = (
        sf.equilibrium(cantilever().with_parameters(P=share * critical_load(), F=0.1)).bendings[0]
        for share in (-2.0, 0.0, 0.9)
    )
    # Of the slope alone, without the load: (24).
    assert pulled.error / pulled.slope**2 == pytest.approx(0.457 * (1 / 3 + 3) / 4, rel=0.03)
    assert free.error / free.slope**2 == pytest.approx(0.457, rel=0.01)
    assert pushed.error / pushed.slope**2 == pytest.approx(0.457 * (10 + 3) / 4, rel=0.1)


def test_a_beam_bent_beyond_the_limit_is_refused_unless_the_limit_is_moved() -> None:
    limp = cantilever().with_parameters(g=60.0)
    with pytest.raises(sf.BeamTheoryError, match="'blade' bends by 10 rad at x = 1 m"):
        sf.equilibrium(limp)
    assert sf.equilibrium(limp, beam_limit=math.inf).bendings[0].error > 5.0
    with pytest.raises(sf.BeamTheoryError):
        sf.equilibrium(cantilever().with_parameters(F=1.0), beam_limit=0.1)


def test_a_column_past_its_critical_load_has_no_bent_equilibrium() -> None:
    past = 1.05 * critical_load()
    with pytest.raises(sf.BeamTheoryError, match="loaded past its critical load"):
        sf.equilibrium(cantilever().with_parameters(P=past, F=1e-3))
    (note,) = sf.equilibrium(cantilever().with_parameters(P=past)).notes
    assert "unstable" in note
    assert not sf.equilibrium(cantilever().with_parameters(P=0.95 * critical_load())).notes


@pytest.mark.parametrize("across", [0.0, 0.05])
def test_a_thrust_that_follows_the_tip_has_no_critical_load_at_rest(across: float) -> None:
    """Beck's column at four times Euler's load: K_t is not symmetric, and its symmetric part says nothing."""
    load, k = sf.BeamLoad((0.0, across, 0.0), at=1.0, axes="world"), math.sqrt(10.0)
    beam = sf.Beam("b", sf.Joint("c"), 1.0, 1.0, EI_z=1.0, bend_y=3, loads=(load,))
    thrust = (sf.Load((-(k**2), 0.0, 0.0)),)
    tip = sf.RigidBody("tip", sf.Joint("j", parent="b", frame="tip"), sf.Inertia(1e-9), loads=thrust)
    model = sf.compile(sf.System("s", (beam, tip), gravity=(0.0, 0.0, 0.0)), sf.Options(backend="interpreter"))
    rest = sf.equilibrium(model)
    assert rest.notes == ()
    deflection = across / k**3 * (math.sin(k) - k * math.cos(k))
    assert model.frame_pose("tip", rest.q)[0][1] == pytest.approx(deflection, rel=0.03)


def test_modes_of_a_state_beyond_the_limit_are_refused() -> None:
    straight, bent = cantilever().neutral(), np.array([0.1, 0.0, 0.0])
    assert not any("theory errs" in note for note in sf.modes(cantilever(), straight).notes)
    assert "beam 'blade' bends" in sf.modes(cantilever(), bent).notes[0]
    with pytest.raises(sf.BeamTheoryError, match="the state of the modes"):
        sf.modes(cantilever(), 10.0 * bent)


def test_a_place_that_needs_a_beam_bent_beyond_its_theory_is_out_of_reach() -> None:
    """Free elastic coordinates stay within small slopes; those that are held may be anything."""

    def reached(height: float, **limit: float) -> sf.Reached:
        q = np.array([height, 0.0, 0.0])
        target = sf.Target(cantilever().frame_pose("tip", q)[0])
        return sf.inverse_kinematics(cantilever(), {"tip": target}, q, held=cantilever().names.v, **limit)

    near, bent, far = reached(0.01), reached(0.2), reached(0.9)
    assert near.converged and not near.notes
    assert bent.converged and "second-order theory errs" in bent.notes[0]
    assert far.error < 1e-9 and not far.converged and far.notes
    assert reached(0.9, beam_limit=math.inf).converged


@pytest.mark.parametrize("family", ["spline", "polynomial", "legendre", "clamped_free", "hermite"])
def test_the_estimate_does_not_depend_on_the_shape_functions(family: str) -> None:
    """Coordinates are displacements [m] or angles [rad]; the deflection under a force at the tip is the same cubic."""
    load = sf.BeamLoad((0.0, 0.0, 2.0 / 9.0), at=1.0, axes="world")
    stated = {"bend_z": 2 if family == "hermite" else 4, "family": family, "loads": (load,)}
    beam = sf.Beam("b", sf.Joint("root", "fixed"), 3.0, 1.0, EI_z=2.0, EI_y=2.0, **stated)
    model = sf.compile(sf.System("s", (beam,), gravity=(0, 0, 0)), sf.Options(backend="interpreter"))
    (bending,) = sf.equilibrium(model).bendings
    assert bending.error == pytest.approx(0.1081, rel=0.05 if family == "clamped_free" else 1e-3)
    assert bending.foreshortening == pytest.approx(1.0 / 15.0, rel=0.02)
    assert bending.twist == 0.0


def test_a_strip_without_equilibrium_is_not_blamed_on_the_start() -> None:
    """The Princeton beam at 13.3 N and 60 degrees: strain energy to second order has no bottom there."""
    load = sf.BeamLoad((0.0, "F/2", "sqrt(3)*F/2"), at=1.0, axes="world")
    counts = {"bend_y": 2, "bend_z": 2, "twist": 2, "family": "legendre", "retain": "all", "loads": (load,)}
    strip = sf.Beam("strip", sf.Joint("root", "fixed"), 0.508, 0.1, 36.28, 2.429, 3.104, rhoJ=1e-6, **counts)
    system = sf.System("strip", (strip,), gravity=(0, 0, 0), parameters=(sf.Parameter("F", 0.0),))
    model = sf.compile(system, sf.Options(backend="interpreter"))
    assert sf.equilibrium(model.with_parameters(F=6.0)).bendings[0].error < 0.06
    with pytest.raises(sf.BeamTheoryError, match="theory of its beams may have none\n(.*\n)*.*'strip'"):
        sf.equilibrium(model.with_parameters(F=13.345), iterations=20)
