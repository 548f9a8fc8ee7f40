"""Readable equations: the compiled model's numbers, the textbook's form."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest
import sympy
from matplotlib.mathtext import MathTextParser
from typer.testing import CliRunner

import symofros as sf
from reference_models import MODELS
from symofros.__main__ import app
from tests.models import compiled, sampled

SMALL = (
    "pendulum",
    "double_pendulum",
    "cart_pole",
    "heavy_top",
    "gyroscope",
    "torque_free_body",
    "friction_arm",
    "flyball_governor",
    "spinning_beam",
    "four_bar",
    "two_four_bars",
    "parallelogram",
    "slider_crank",
    "sleigh",
    "rolling_disc",
    "andrews_squeezer",
)

# In every run: rates of angles, inputs, spatial motion, friction, a beam, loops, a condition on speeds.
FEW = ("double_pendulum", "cart_pole", "gyroscope", "friction_arm", "spinning_beam", "four_bar", "sleigh")


@cache
def readable(name: str) -> sf.ReadableEquations:
    return sf.equations(MODELS[name])


def function(equations: sf.ReadableEquations) -> Callable[..., tuple[Any, ...]]:
    names: dict[str, Any] = {}
    exec(equations.numpy_source(), names)
    return next(value for value in names.values() if type(value).__name__ == "function")


@pytest.mark.parametrize("name", sampled(SMALL, FEW))
def test_the_source_gives_the_compiled_models_numbers(name: str, rng: np.random.Generator) -> None:
    model = compiled(name)
    written = function(readable(name))
    for _ in range(5):
        q, v = model.random_state(rng)
        u = rng.standard_normal(model.nu)
        expected = [*model.dynamics(q, v, u), model.constraint_jacobian(q) if model.nc else np.zeros((0, model.nv))]
        for array, right in zip(written(q, v, u), expected, strict=True):
            # Sums of some hundred terms, whose order differs.
            np.testing.assert_allclose(array, right, rtol=0, atol=1e-12 * max(1.0, np.abs(right).max(initial=0.0)))


def test_the_source_of_minima_and_maxima_gives_the_compiled_models_numbers(rng: np.random.Generator) -> None:
    parameters = (sf.Parameter("k", 30.0), sf.Parameter("a", 0.2))
    stop = sf.Stop("k", 2.0, "-a", "max(a, min(3*a, min(0.5, k)))")  # type: ignore[arg-type]
    joint = sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=(stop,), effort=("max(u1, max(dx, 0.1))*min(x, u1)",))
    body = sf.RigidBody("block", joint, sf.Inertia(1.3))
    system = sf.System("stopped", (body,), parameters, inputs=(sf.Input("u1"),))
    model, written = sf.compile(system), function(sf.equations(system))
    for q, v, u in rng.normal(size=(20, 3, 1)):
        for array, right in zip(written(q, v, u)[:3], model.dynamics(q, v, u), strict=True):
            np.testing.assert_allclose(array, right, rtol=1e-12, atol=1e-12)


def test_the_double_pendulum_matches_the_textbook() -> None:
    system = sf.System(
        "point_masses",
        bodies=[
            sf.RigidBody(
                "upper",
                sf.Joint("q1", "revolute", axis=(0, -1, 0), rotation=sf.Rotation.rpy(0, "pi/2", 0)),
                sf.Inertia("m1", ("l1", 0, 0)),
                frames=[sf.Frame("elbow", ("l1", 0, 0))],
            ),
            sf.RigidBody(
                "lower",
                sf.Joint("q2", "revolute", parent="upper", frame="elbow", axis=(0, -1, 0)),
                sf.Inertia("m2", ("l2", 0, 0)),
            ),
        ],
        parameters=[sf.Parameter(name, 1.0) for name in ("m1", "m2", "l1", "l2")],
    )
    equations = sf.equations(system)
    symbols = {symbol.name: symbol for group in equations.symbols.values() for symbol in group}
    q1, q2, dq1, dq2 = (symbols[name] for name in ("q1", "q2", "dq1", "dq2"))
    m1, m2, l1, l2, g = (symbols[name] for name in ("m1", "m2", "l1", "l2", "g"))
    c2 = sympy.cos(q2)
    right = sympy.Matrix(
        [[m1 * l1**2 + m2 * (l1**2 + l2**2 + 2 * l1 * l2 * c2), m2 * (l2**2 + l1 * l2 * c2)], [0, m2 * l2**2]]
    )
    right[1, 0] = right[0, 1]
    weight = g * (m1 + m2) * l1 * sympy.sin(q1) + g * m2 * l2 * sympy.sin(q1 + q2)
    h1 = -m2 * l1 * l2 * sympy.sin(q2) * (2 * dq1 + dq2) * dq2 + weight
    assert (equations.M - right).expand() == sympy.zeros(2, 2)
    assert (equations.h[0] - h1).expand() == 0
    # The sum of the angles has been combined, and nothing longer than the textbook's has been left.
    assert equations.h[0].has(sympy.sin(q1 + q2))
    assert sympy.count_ops(equations.h[0]) <= sympy.count_ops(h1)
    assert sympy.count_ops(equations.M) <= sympy.count_ops(right)


@pytest.mark.parametrize("name", ["double_pendulum", "four_bar"])
def test_latex_can_be_parsed(name: str) -> None:
    parser = MathTextParser("path")
    body = readable(name).latex().splitlines()[1:-1]
    assert len(body) > 3
    for line in body:
        parser.parse("$" + line.removesuffix("\\\\").replace("&", "").replace("\\operatorname", "\\mathrm") + "$")


@pytest.mark.parametrize("name", ["puma560", "stewart", "flexible_arm"])
def test_large_models_are_refused_and_have_their_recursion(name: str) -> None:
    equations = sf.equations(MODELS[name])
    assert not equations.is_small
    with pytest.raises(sf.ExportError, match="at most 300 operations"):
        _ = equations.M
    text = equations.recursion()
    assert text.count("\\paragraph") == sum("{Link" in line for line in text.splitlines()) >= 6
    assert text.count("\\begin") == text.count("\\end") and text.count("{") == text.count("}")


def test_names_that_python_reserves_are_changed(rng: np.random.Generator) -> None:
    system = sf.System(
        "odd names",
        bodies=[sf.RigidBody("b", sf.Joint("lambda", "prismatic", actuated=True), sf.Inertia("M"))],
        parameters=[sf.Parameter("M", 2.0)],
    )
    M, h, Q, G = function(sf.equations(system))([0.1], [0.2], [3.0])
    assert M == [[2.0]] and Q == [3.0] and G.shape == (0, 1)
    np.testing.assert_allclose(h, [2.0 * 9.81])


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ([], "M[2,2] = L**2*m/3"),
        (["--latex"], "\\frac{L^{2} m}{3}"),
        (["--numpy"], "def four_bar(q, v, u, par=(1.0, 1.0), t=0.0):"),
        (["--recursion"], "\\paragraph{Link 3 (rocker)}"),
    ],
)
def test_the_equations_command_prints_text_latex_numpy_or_recursion(words: list[str], says: str) -> None:
    done = CliRunner().invoke(app, ["equations", "reference_models/closed/four_bar.yaml", *words])
    assert done.exit_code == 0 and says in done.output


def test_a_recursion_says_how_joints_move() -> None:
    """Pitch of a screw; place and rotation of a joint by formulas; none where they are at rest."""
    screw = sf.RigidBody("nut", sf.Joint("s", "screw", axis=(0, 0, 1), pitch="2*h"), sf.Inertia(1.0))
    cam = sf.Joint(
        "g",
        "general",
        "nut",
        coordinates=("c",),
        moving_position=("r*c", 0, "c^2"),
        moving_rotation=sf.Rotation.quaternion("sin(c)", 0, 0, "cos(c)"),
    )
    parameters = (sf.Parameter("h", 0.1), sf.Parameter("r", 0.2))
    text = sf.equations(sf.System("s", (screw, sf.RigidBody("cam", cam, sf.Inertia(1.0))), parameters)).recursion()
    nut, moved = text.split("\\paragraph{Link 2")
    assert "pitch} &= 2 h" in nut and "p_{PD}" not in nut
    assert re.search(r"p_\{PD\} &= .*c r|p_\{PD\} &= .*r c", moved) and "c^{2}" in moved and "pitch" not in moved
    assert "R_{PD} &= \\text{quaternion}(" in moved


def test_forces_and_constraints_are_their_models(rng: np.random.Generator) -> None:
    """Q of what acts, G of what holds, each by its name; the number of operations is that of all."""
    hinge = sf.Joint("a", "revolute", axis=(0, 1, 0), effort=("-k*a + u",))
    slide = sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=(sf.Damper(0.3),))
    bodies = sf.RigidBody("arm", hinge, sf.Inertia(1.0, (1, 0, 0))), sf.RigidBody("block", slide, sf.Inertia(2.0))
    gear = sf.Coupling("gear", sf.formula("x - sin(a)"))
    system = sf.System("s", bodies, (sf.Parameter("k", 2.0),), inputs=(sf.Input("u"),), constraints=(gear,))
    equations, model = sf.equations(system), sf.compile(system, sf.Options(backend="interpreter"))
    q, v, u = rng.standard_normal(2), rng.standard_normal(2), rng.standard_normal(1)
    symbols = {"a": q[0], "x": q[1], "da": v[0], "dx": v[1], "k": 2.0, "u": u[0]}

    def number(matrix: Any) -> np.ndarray:
        values = {one: symbols[str(one)] for one in matrix.free_symbols}
        return np.array(matrix.subs(values).evalf(), dtype=float)

    np.testing.assert_allclose(number(equations.Q).ravel(), model.generalized_force(q, v, u), rtol=1e-12)
    np.testing.assert_allclose(number(equations.G), model.constraint_jacobian(q), rtol=1e-12)
    assert equations.operations > 0 and str(equations.operations) in repr(equations)
