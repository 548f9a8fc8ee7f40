"""The regressor against Pinocchio's, and the base parameters that it reveals."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from tests.late import require
from tests.models import sampled
from validation.adapters.pinocchio import tree as pin_adapter
from validation.contract.interface import Subject

pin = require("pinocchio", "validation")
FUNCTIONS = sf.Options(functions=("regressor", "bias", "mass_matrix"))


@pytest.mark.parametrize("name", sampled(("pendulum", "rx90", "space_arm", "mss"), ("rx90", "space_arm")))
def test_regressors_match_pinocchio(name: str) -> None:
    system = MODELS[name]
    m, engine = sf.compile(system, FUNCTIONS), pin_adapter.build(Subject(name, system))
    rng = np.random.default_rng(0)
    for _ in range(3):
        q, v = m.random_state(rng)
        a = rng.normal(size=m.nv)
        chart = engine.chart
        state = (chart.coordinates(q[None])[0], chart.speeds(q[None], v[None])[0])
        acceleration = chart.accelerations(q[None], v[None], a[None])[0]
        theirs = pin.computeJointTorqueRegressor(engine.model, engine.model.createData(), *state, acceleration)
        ours = m.regressor(q, v, a)
        theirs = np.reshape(theirs, ours.shape)
        assert np.abs(ours - theirs).max() < 1e-11 * np.abs(theirs).max()


@pytest.mark.parametrize(("name", "count"), [("pendulum", 3), ("rx90", 36)])
def test_base_parameters_have_the_known_count_and_reproduce_the_regressor(name: str, count: int) -> None:
    """A swinging body reveals one moment and two first moments; an arm like rx90 36 combinations of 60 parameters."""
    m = sf.compile(MODELS[name], FUNCTIONS)
    base = sf.base_parameters(m)
    rng = np.random.default_rng(5)
    q, v = m.random_state(rng)
    a, pi = rng.normal(size=m.nv), rng.normal(size=base.combine.shape[1])
    Y = m.regressor(q, v, a)
    assert Y[:, base.independent] @ (base.combine @ pi) == pytest.approx(Y @ pi, rel=1e-9, abs=1e-9)
    assert len(base.independent) == count


def test_base_parameters_are_named_by_masses_and_moments() -> None:
    """By hand: the lower rod's mass counts with the upper rod as a point at their joint, 0.5 m away."""
    base = sf.base_parameters(sf.compile(MODELS["double_pendulum"], FUNCTIONS))
    assert base.names == (
        "mx(upper) + 0.5 m(lower)",
        "mz(upper)",
        "Iyy(upper) + 0.25 m(lower)",
        "mx(lower)",
        "mz(lower)",
        "Iyy(lower)",
    )
    assert str(base).splitlines() == list(base.names)


@pytest.mark.parametrize("length", [1e-6, 1e6, 1e9])
def test_base_parameters_of_mechanisms_of_any_size(length: float) -> None:
    """The same by hand: coefficients are lengths and their squares, of a micrometre as of a gigametre."""
    inertia = sf.Inertia(1.5, (length / 2, 0, 0), (0, length**2, length**2))
    joints = [
        sf.Joint("q1", "revolute", axis=(0, 1, 0)),
        sf.Joint("q2", "revolute", "upper", "elbow", axis=(0, 1, 0)),
    ]
    elbow = (sf.Frame("elbow", (length, 0, 0)),)
    bodies = [sf.RigidBody(name, joint, inertia, elbow) for name, joint in zip(("upper", "lower"), joints, strict=True)]
    base = sf.base_parameters(sf.compile(sf.System("sized", bodies), FUNCTIONS))
    by_hand = f"mx(upper) + {length:.6g} m(lower)", "mz(upper)", f"Iyy(upper) + {length**2:.6g} m(lower)"
    assert base.names == (*by_hand, "mx(lower)", "mz(lower)", "Iyy(lower)") and not base.notes


def test_base_parameters_of_a_loop_are_those_of_its_motions() -> None:
    """By hand: the slider counts as a point at the rod's end, and the rod's mass as a point at the crank's."""
    m = sf.compile(MODELS["slider_crank"])
    base = sf.base_parameters(m)
    assert base.names == (
        "Izz(crank) + 0.0225 m(rod) + 0.0225 m(slider)",
        "mx(rod) + 0.3 m(slider)",
        "my(rod)",
        "Izz(rod) + 0.09 m(slider)",
    )
    on = sf.assemble(m, [0.7, -0.5, 0.3], np.ones(3))
    a = np.asarray(m.forward_dynamics(on.q, on.v, [0.4]))
    M, h, _ = m.dynamics(on.q, on.v, [0.4])
    allowed = np.linalg.svd(m.constraint_jacobian(on.q))[2][-1]
    masses = {"m(rod)": 0.151104, "mx(rod)": 0.151104 * 0.15, "m(slider)": 0.075552}
    masses |= {"Izz(crank)": 0.36 * 0.0075, "Izz(rod)": 0.151104 * 0.03}
    pi = np.array([masses.get(name, 0.0) for name in base.columns])
    efforts = allowed @ m.regressor(on.q, on.v, a)[:, base.independent] @ base.combine @ pi
    assert efforts == pytest.approx(allowed @ (M @ a + h), rel=1e-9) and abs(efforts) > 1e-3


def test_terms_of_joints_complete_inverse_dynamics(rng: np.random.Generator) -> None:
    """Y pi with viscous and Coulomb friction and armatures is what the motion takes, M a + h - Q."""
    inertia = sf.Inertia(1.3, (0.1, 0.2, -0.1), (0.3, 0.4, 0.5))
    elements = [[sf.Damper(0.7), sf.Friction(0.1)], [sf.Friction(0.4, minimum_velocity=0.02, viscous=0.3)]]
    bodies = [
        sf.RigidBody(name, sf.Joint(f"q{k}", "revolute", parent, axis=axis, elements=each, armature=0.2 * k), inertia)
        for k, (name, parent, axis, each) in enumerate(
            zip(("a", "b"), ("world", "a"), ((0, 1, 0), (1, 0, 0)), elements, strict=True)
        )
    ]
    m = sf.compile(sf.System("braked", bodies))
    q, v, a = rng.normal(size=(3, 50, 2))
    v[:10] *= 1e-3  # Where the sign is smoothed.
    second = np.diag([0.3, 0.4, 0.5]) + 1.3 * (0.06 * np.eye(3) - np.outer(*2 * [[0.1, 0.2, -0.1]]))
    Ixx, Ixy, Ixz, Iyy, Iyz, Izz = second[np.triu_indices(3)]
    link = [1.3, 0.13, 0.26, -0.13, Ixx, Ixy, Iyy, Ixz, Iyz, Izz]
    pi = [*link, *link, 0.7, 0.3, 0.1, 0.4, 0.0, 0.2]
    terms = ("viscous", "coulomb", "armature")
    Y = m.regressor(q, v, a, joint_terms=terms, minimum_velocity=[1e-3, 0.02])
    np.testing.assert_allclose(Y @ pi, m.inverse_dynamics(q, v, a), rtol=1e-12, atol=1e-12)
    columns = m.regressor_columns(terms)
    assert len(columns) == Y.shape[-1]
    assert columns[9:12] == ("Izz(a)", "m(b)", "mx(b)")
    assert columns[20:22] == ("viscous(q0)", "viscous(q1)")
    assert Y[0, :, 20:22].tolist() == np.diag(v[0]).tolist()


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"joint_terms": "viscous"}, "one alone"),
        ({"joint_terms": ("stiction",)}, "viscous, coulomb, armature"),
        ({"joint_terms": ("coulomb",), "minimum_velocity": 0.0}, "above zero"),
        ({"joint_terms": ("coulomb",), "minimum_velocity": [1.0, 1.0, 1.0]}, "each of 2 speeds"),
    ],
)
def test_invalid_terms_of_the_regressor_are_refused(given: dict[str, Any], words: str) -> None:
    m = sf.compile(MODELS["double_pendulum"], FUNCTIONS)
    with pytest.raises(sf.SymofrosError, match=words):
        m.regressor([0.1, 0.2], [0.0, 0.0], [0.0, 0.0], **given)


@pytest.mark.parametrize(("name", "noted"), [("rx90", 0), ("gyroscope", 1), ("flexible_pendulum", 1)])
def test_efforts_that_no_parameters_give_are_noted(name: str, noted: int) -> None:
    base = sf.base_parameters(sf.compile(MODELS[name], FUNCTIONS))
    assert [note.startswith("no parameters give all of M a + h: ") for note in base.notes] == [True] * noted
    assert str(base).endswith("gyroscopic moments of rotors and beams have none") == bool(noted)


def test_armatures_are_noted_where_their_columns_are_left_out() -> None:
    model = sf.compile(MODELS["puma560"], FUNCTIONS)
    assert len(sf.base_parameters(model).notes) == 1
    assert not sf.base_parameters(model, joint_terms=("armature",)).notes


def test_samples_that_are_too_few_to_tell_are_refused() -> None:
    """Six equations a sample: five miss six of 36 base parameters."""
    model = sf.compile(MODELS["rx90"], FUNCTIONS)
    with pytest.raises(sf.ArgumentError, match="5 samples give 30 equations, all independent"):
        sf.base_parameters(model, samples=5)
    assert len(sf.base_parameters(model, samples=7).names) == 36


def arm_and_rows(amplitude: float) -> tuple[sf.Model, np.ndarray, np.ndarray]:
    """A double pendulum whose joints follow sines of two frequencies; its regressor, and the efforts of its motion."""
    m = sf.compile(MODELS["double_pendulum"], FUNCTIONS)
    t, rates = np.linspace(0.0, 10.0, 400)[:, None], np.array([1.0, 1.4])
    q = amplitude * np.sin(rates * t)
    v, a = amplitude * rates * np.cos(rates * t), -(rates**2) * q
    return m, m.regressor(q, v, a), np.einsum("...ij,...j->...i", m.mass_matrix(q), a) + m.bias(q, v)


def test_fits_have_the_deviations_of_repeated_measurements() -> None:
    """Of 400 fits to efforts with noise of two sizes; their mean is the value without noise."""
    m, Y, efforts = arm_and_rows(1.0)
    base, rng, noise = sf.base_parameters(m), np.random.default_rng(0), np.array([0.01, 0.3])
    exact = base.fit(Y, efforts)
    np.testing.assert_allclose(Y[..., base.independent] @ exact.values, efforts, atol=1e-12)
    fits = [base.fit(Y, efforts + noise * rng.normal(size=efforts.shape), noise) for _ in range(400)]
    spread = np.std([fit.values for fit in fits], axis=0)
    np.testing.assert_allclose(spread, fits[0].deviations, rtol=0.15)  # 400 draws tell them to 3.5 %, sigma to 2.5 %.
    np.testing.assert_allclose(
        np.mean([fit.values for fit in fits], axis=0), exact.values, atol=4.0 * spread.max() / 20
    )
    assert fits[0].residual == pytest.approx(1.0, rel=0.1) and not exact.notes and exact.condition < 100.0
    assert str(exact).splitlines()[0].endswith("  mx(upper) + 0.5 m(lower)")


def test_motions_that_do_not_show_parameters_are_noted() -> None:
    """Six degrees, and postures at rest, which show no moment of inertia: both were fitted without a word."""
    m, Y, efforts = arm_and_rows(0.1)
    base = sf.base_parameters(m)
    (small,) = base.fit(Y, efforts).notes
    assert small.startswith("the motion tells base parameters poorly apart: ") and "Iyy(upper)" in small
    postures = np.random.default_rng(1).uniform(-1.0, 1.0, (60, 2))
    rest = np.zeros_like(postures)
    static = base.fit(m.regressor(postures, rest, rest), m.bias(postures, rest))
    assert static.notes[0].startswith("the motion determines 4 of 6 base parameters, and not Iyy(upper), Iyy(lower): ")
    assert np.isinf(static.condition) and np.isinf(static.deviations).tolist() == [False, False, True] * 2
    near = 0.5 + 1e-3 * postures
    both = base.fit(m.regressor(near, rest, rest), m.bias(near, rest)).notes
    assert len(both) == 2 and both[1].startswith("the motion tells base parameters poorly apart: mx(")
    np.testing.assert_allclose(
        static.values[[0, 1, 3, 4]], base.fit(*arm_and_rows(1.0)[1:]).values[[0, 1, 3, 4]], atol=1e-12
    )


def test_columns_of_rounding_determine_nothing() -> None:
    """Of a joint held at 90 degrees: cos(pi/2) = 6e-17 gave its first moment 7e11 kg m, and that of z no deviation."""
    m, t = sf.compile(MODELS["double_pendulum"], FUNCTIONS), np.linspace(0.0, 10.0, 400)[:, None]
    q = np.hstack([np.full_like(t, np.pi / 2), np.sin(t)])
    v, a = np.hstack([0.0 * t, np.cos(t)]), np.hstack([0.0 * t, -np.sin(t)])
    efforts = np.einsum("...ij,...j->...i", m.mass_matrix(q), a) + m.bias(q, v)
    efforts += np.random.default_rng(0).normal(0.0, 0.01, efforts.shape)
    found = sf.base_parameters(m).fit(m.regressor(q, v, a), efforts)
    assert np.isinf(found.deviations).tolist() == [True, False, True] + [False] * 3
    assert found.values[[0, 2]].tolist() == [0.0, 0.0] and abs(found.values[1]) < 5.0 * found.deviations[1]


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"efforts": np.zeros(2)}, "efforts does not fit"),
        ({"regressor": np.zeros((9, 2, 6))}, "regressor does not fit"),
        ({"noise": [1.0]}, r"noise does not fit(\n.*)*one number a row"),
        ({"noise": [1.0, 0.0]}, "above zero"),
        ({"efforts": np.full((9, 2), np.nan)}, "not finite"),
        ({"regressor": np.zeros((3, 2, 20)), "efforts": np.zeros((3, 2))}, "6 equations for 6 parameters"),
    ],
)
def test_arrays_that_are_no_measurement_are_refused(given: dict[str, Any], words: str) -> None:
    base = sf.base_parameters(sf.compile(MODELS["double_pendulum"], FUNCTIONS))
    with pytest.raises(sf.SymofrosError, match=words):
        base.fit(**({"regressor": np.zeros((9, 2, 20)), "efforts": np.zeros((9, 2))} | given))
