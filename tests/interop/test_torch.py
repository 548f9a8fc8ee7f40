"""PyTorch's own checkers on the dynamics, and the model's numbers."""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from tests.interop.turning import SYSTEMS, rate_matrix, states, turns, unit
from tests.late import late

torch = late("torch", extra="torch")


@pytest.fixture(scope="module")
def model() -> sf.Model:
    return sf.compile(MODELS["cart_pole"])


@pytest.fixture(scope="module")
def dynamics(model: sf.Model) -> Any:
    return sf.interop.torch.Dynamics(model)


def tensors(model: sf.Model, n: int, third: int) -> list[Any]:
    rng = np.random.default_rng(3)
    q, v = (torch.tensor(rng.standard_normal((n, model.nv)), requires_grad=True) for _ in range(2))
    w = torch.tensor(rng.standard_normal((n, third)), requires_grad=True)
    par = torch.tensor(model.parameter_values, requires_grad=True)
    return [q, v, w, par]


@pytest.mark.parametrize("name", ["forward_dynamics", "inverse_dynamics"])
def test_gradients_pass_torchs_checker_in_both_modes(dynamics: Any, model: sf.Model, name: str) -> None:
    given = tensors(model, 3, model.nu if name == "forward_dynamics" else model.nv)
    assert torch.autograd.gradcheck(getattr(dynamics, name), given, check_forward_ad=True, check_batched_grad=True)


def test_functional_transforms_give_the_models_derivatives(dynamics: Any, model: sf.Model) -> None:
    q, v, u, _ = (x.detach() for x in tensors(model, 4, model.nu))
    by_q, by_v, by_u = model.forward_dynamics_derivatives(q.numpy(), v.numpy(), u.numpy())
    for transform in (torch.func.jacrev, torch.func.jacfwd):
        slopes = torch.func.vmap(transform(dynamics.forward_dynamics, argnums=(0, 1, 2)))(q, v, u)
        for slope, right in zip(slopes, (by_q, by_v, by_u), strict=True):
            np.testing.assert_allclose(slope.numpy(), right, rtol=1e-12, atol=1e-12)


def test_dynamics_can_be_sent_to_other_processes(dynamics: Any, model: sf.Model) -> None:
    q, v, u, _ = (x.detach() for x in tensors(model, 2, model.nu))
    again = pickle.loads(pickle.dumps(dynamics))
    assert torch.equal(again.forward_dynamics(q, v, u), dynamics.forward_dynamics(q, v, u))


def test_compiled_programs_call_the_model_as_it_stands(dynamics: Any, model: sf.Model) -> None:
    def loss(q: Any, v: Any, u: Any) -> Any:
        return dynamics.forward_dynamics(2.0 * q, v, u).sin().sum()

    given = tensors(model, 3, model.nu)[:3]
    values = [function(*given) for function in (loss, torch.compile(loss, backend="eager"))]
    (value, slopes), (compiled, others) = ((x, torch.autograd.grad(x, given)) for x in values)
    assert torch.equal(compiled, value)
    assert all(torch.equal(a, b) for a, b in zip(slopes, others, strict=True))


def test_tensors_that_are_negatives_by_a_bit_are_read(dynamics: Any, model: sf.Model) -> None:
    q, v, u, _ = (x.detach() for x in tensors(model, 2, model.nu))
    negative = torch.complex(v, -v).conj().imag  # v, stored as -v.
    assert torch.equal(dynamics.forward_dynamics(q, negative, u), dynamics.forward_dynamics(q, v, u))


def test_second_derivatives_are_refused(dynamics: Any, model: sf.Model) -> None:
    q, v, u, _ = tensors(model, 1, model.nu)
    (slope,) = torch.autograd.grad(dynamics.forward_dynamics(q, v, u).sum(), q, create_graph=True)
    with pytest.raises(sf.SymofrosError, match="second derivatives"):
        slope.sum().backward()


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"par": lambda x: x.float()}, r"'par' can't be taken(.|\n)*par\.double\(\)"),
        ({"q": lambda x: x.float()}, "float64 on the CPU"),
        ({"q": lambda x: np.zeros(2)}, "torch.as_tensor"),
        *(({name: lambda x: None}, f"'{name}' can't be taken(.|\n)*NoneType") for name in "qvu"),
    ],
)
def test_arguments_that_are_not_double_tensors_are_refused(
    dynamics: Any, model: sf.Model, changed: dict[str, Any], words: str
) -> None:
    given = dict(zip(("q", "v", "u", "par"), tensors(model, 1, model.nu), strict=True))
    with pytest.raises(sf.SymofrosError, match=words):
        dynamics.forward_dynamics(**given | {name: change(given[name]) for name, change in changed.items()})


def test_loops_keep_their_constraints_in_the_derivatives() -> None:
    four_bar = sf.compile(MODELS["four_bar"])
    closed = sf.assemble(four_bar, [1.2, -1.2, 1.2])
    wrapped = sf.interop.torch.Dynamics(four_bar)
    q, v = torch.tensor(closed.q), torch.tensor(closed.v)
    u = torch.zeros(four_bar.nu, dtype=torch.float64)
    slope = torch.func.jacrev(wrapped.forward_dynamics)(q, v, u)
    np.testing.assert_allclose(
        slope.numpy(), four_bar.forward_dynamics_derivatives(closed.q, closed.v, u.numpy())[0], rtol=1e-12, atol=1e-12
    )


@pytest.fixture(scope="module", params=SYSTEMS)
def turning(request: pytest.FixtureRequest) -> tuple[sf.Model, Any]:
    m = sf.compile(SYSTEMS[request.param]())
    return m, sf.interop.torch.Dynamics(m)


def leaves(*arrays: np.ndarray) -> list[Any]:
    return [torch.tensor(x, requires_grad=True) for x in arrays]


@pytest.mark.parametrize("name", ["forward_dynamics", "inverse_dynamics"])
def test_quaternions_of_any_length_pass_torchs_checker(turning: tuple[sf.Model, Any], name: str) -> None:
    m, wrapped = turning
    rng = np.random.default_rng(5)
    q, v = states(m, 2, rng)
    third = rng.standard_normal((2, m.nu if name == "forward_dynamics" else m.nv))
    given = leaves(q, v, third, m.parameter_values)
    f = getattr(wrapped, name)
    np.testing.assert_allclose(
        f(*given).detach().numpy(), getattr(m, name)(unit(m, q), v, third), rtol=1e-12, atol=1e-12
    )
    assert torch.autograd.gradcheck(f, given, check_forward_ad=True, check_batched_grad=True)


def test_derivatives_by_coordinates_are_those_along_the_manifold(turning: tuple[sf.Model, Any]) -> None:
    m, wrapped = turning
    rng = np.random.default_rng(6)
    q, v = (x[0] for x in states(m, 1, rng))
    a, at = rng.standard_normal(m.nv), unit(m, q)

    def slope(q: np.ndarray) -> np.ndarray:
        return torch.func.jacrev(wrapped.inverse_dynamics)(*map(torch.tensor, (q, v, a))).numpy()

    np.testing.assert_allclose(slope(at) @ rate_matrix(m, at), m.inverse_dynamics_derivatives(at, v, a)[0], atol=1e-7)
    for turn in turns(m):
        np.testing.assert_allclose(slope(q)[:, turn] @ q[turn], 0.0, atol=1e-12 * np.abs(slope(q)).max())


@pytest.mark.parametrize("scale", [0.0, 1e-2, 2.5])
def test_motions_along_the_manifold_are_the_models(turning: tuple[sf.Model, Any], scale: float) -> None:
    m, wrapped = turning
    rng = np.random.default_rng(7)
    q, dq = states(m, 2, rng)
    dq *= scale / max(1.0, float(np.abs(dq).max()))
    ends = m.integrate(unit(m, q), dq)
    given = leaves(q, dq)
    np.testing.assert_allclose(wrapped.integrate(*given).detach().numpy(), ends, rtol=1e-13, atol=1e-14)
    back = wrapped.difference(given[0], torch.tensor(ends)).detach().numpy()
    np.testing.assert_allclose(back, dq, rtol=1e-9, atol=1e-14)
    assert torch.autograd.gradcheck(wrapped.integrate, given, check_forward_ad=True)
    assert torch.autograd.gradgradcheck(wrapped.coordinate_rates, given)
    assert torch.autograd.gradcheck(wrapped.difference, leaves(q, ends))


def test_wrong_shapes_are_refused(dynamics: Any) -> None:
    zeros = torch.zeros(3, dtype=torch.float64)
    with pytest.raises(sf.SymofrosError, match=r"\(\.\.\., 2\)"):
        dynamics.forward_dynamics(zeros, zeros, zeros)


def test_a_model_of_single_precision_computes_in_doubles(model: sf.Model) -> None:
    q, v, u, _ = (x.detach() for x in tensors(model, 2, model.nu))
    single = sf.interop.torch.Dynamics(model.with_precision("single")).forward_dynamics(q, v, u)
    assert single.dtype == torch.float64
    np.testing.assert_array_equal(single.numpy(), model.forward_dynamics(q.numpy(), v.numpy(), u.numpy()))


def test_a_robot_with_a_floating_base_is_taken_from_its_urdf(tmp_path: Path) -> None:
    inertial = """<inertial><mass value="2"/>
        <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>"""
    (tmp_path / "hip.urdf").write_text(f"""<robot name="hip"><link name="base">{inertial}</link>
        <link name="thigh">{inertial}</link><joint name="hip" type="revolute"><parent link="base"/><child link="thigh"/>
        <axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="10" velocity="5"/></joint></robot>""")
    m = sf.compile(sf.load(tmp_path / "hip.urdf", floating_base=True))
    wrapped = sf.interop.torch.Dynamics(m)
    q, v, u = leaves(m.neutral(), np.ones(m.nv), np.ones(m.nu))
    wrapped.integrate(q, 0.1 * wrapped.forward_dynamics(q, v, u)).sum().backward()
    assert q.grad.shape == (m.nq,) and bool(q.grad.isfinite().all())
