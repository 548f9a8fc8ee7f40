"""Generated C computes what the graph says: bit for bit without contraction, within rounding as shipped."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.mechanics.topology.tree import build_tree
from tests.models import CASES, sampled, system

EXACT_FLAGS = ("-O2", "-ffp-contract=off")
# Fused multiply-add changes each operation by half an ulp of its result; sums of some hundred terms keep below this.
SHIPPED = 1e-13
COMPARED = (
    "mass_matrix",
    "bias",
    "generalized_force",
    "dynamics",
    "forward_dynamics",
    "inverse_dynamics",
    "kinetic_energy",
    "potential_energy",
    "frame_pose",
    "frame_velocity",
    "frame_acceleration",
    "frame_jacobian",
    "frame_jacobian_rate",
)


def everything(model: sf.Model, rng: np.random.Generator, n: int = 50) -> dict[str, np.ndarray]:
    """What the functions return over the same states, by name; those that solve at run time have their own tests."""
    pairs = [model.random_state(rng) for _ in range(n)]
    q, v = np.array([q for q, _ in pairs]), np.array([v for _, v in pairs])
    u, a = rng.standard_normal((n, model.nu)), rng.standard_normal((n, model.nv))
    M, h, Q = model.dynamics(q, v, u)
    frame = model.names.frames[-1]
    p, R = model.frame_pose(frame, q)
    return {
        "M": model.mass_matrix(q),
        "h": model.bias(q, v),
        "Q": model.generalized_force(q, v, u),
        "dynamics": np.concatenate([M.reshape(n, -1), h, Q], axis=1),
        "forward": model.forward_dynamics(q, v, u),
        "inverse": model.inverse_dynamics(q, v, a),
        "T": model.kinetic_energy(q, v),
        "V": model.potential_energy(q),
        "p": p,
        "R": R,
        "frame_velocity": model.frame_velocity(frame, q, v),
        "frame_acceleration": model.frame_acceleration(frame, q, v, a),
        "J": model.frame_jacobian(frame, q),
        "dJ": model.frame_jacobian_rate(frame, q, v),
    }


def built(case: str, **options: object) -> sf.Model:
    s = system(case)
    return sf.compile(s, sf.Options(functions=COMPARED, frames=(build_tree(s).frames[-1].name,), **options))  # type: ignore[arg-type]


# Of each kind of joint, rotors, friction, parameters; large trees take seconds each to compile, and one with parameters
# is compared as shipped below.
SMALL = ("double_pendulum", "heavy_top", "gyroscope", "friction_arm", "joint_zoo")


@pytest.mark.parametrize("case", sampled(CASES, SMALL))
def test_c_equals_interpreter_bits_without_contraction(case: str) -> None:
    c, twin = built(case, flags=EXACT_FLAGS), built(case, backend="interpreter")
    results = everything(c, np.random.default_rng(1)), everything(twin, np.random.default_rng(1))
    for name, values in results[0].items():
        assert np.array_equal(values, results[1][name]), name


@pytest.mark.parametrize("way", ["articulated", "factors"])
@pytest.mark.parametrize(
    "case",
    [
        "heavy_top",
        "gyroscope",
        "flexible_pendulum",
        pytest.param("parametrised1", marks=pytest.mark.slow),
        pytest.param("joints2", marks=pytest.mark.slow),
        pytest.param("flexible_arm", marks=pytest.mark.slow),
    ],
)
def test_both_forward_dynamics_methods_equal_interpreter_bits(
    case: str, way: Literal["articulated", "factors"]
) -> None:
    """One state at a time, by batches in vectors, in NumPy."""
    stated = MODELS[case] if case in MODELS else system(case)
    options = sf.Options(("forward_dynamics",), (), flags=EXACT_FLAGS, forward_dynamics=way)
    c, twin = sf.compile(stated, options), sf.compile(stated, replace(options, backend="interpreter"))
    rng = np.random.default_rng(4)
    pairs = [c.random_state(rng) for _ in range(600)]  # Batches go by vectors from 512 states on.
    q, v = np.array([q for q, _ in pairs]), np.array([v for _, v in pairs])
    u = rng.standard_normal((600, c.nu))
    expected = twin.forward_dynamics(q, v, u)
    np.testing.assert_array_equal(c.forward_dynamics(q, v, u), expected)
    np.testing.assert_array_equal(c.forward_dynamics(q[7], v[7], u[7]), expected[7])


@pytest.mark.parametrize("case", sampled(("tree0", "tree3", "parametrised1"), ("parametrised1",)))
def test_c_matches_interpreter_within_rounding_with_default_flags(case: str) -> None:
    c, twin = built(case), built(case, backend="interpreter")
    results = everything(c, np.random.default_rng(2)), everything(twin, np.random.default_rng(2))
    for name, values in results[0].items():
        scale = max(1.0, np.abs(results[1][name]).max())
        # Forward dynamics divides by M, whose condition multiplies the rounding.
        tolerance = SHIPPED * (1e4 if name == "forward" else 1.0) * scale
        np.testing.assert_allclose(values, results[1][name], atol=tolerance, err_msg=name)


def test_chunks_compute_the_same_bits(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Values that cross chunks go through reused work slots; none may be overwritten early."""
    from symofros.generator.codegen import function

    monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path))  # Where no library of longer chunks is known.
    monkeypatch.setattr(function, "MAX_STATEMENTS", 7)
    c, twin = built("friction_arm", flags=EXACT_FLAGS), built("friction_arm", backend="interpreter")
    results = everything(c, np.random.default_rng(3)), everything(twin, np.random.default_rng(3))
    for name, values in results[0].items():
        assert np.array_equal(values, results[1][name]), name
