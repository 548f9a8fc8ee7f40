"""What the symbolic peers compute."""

from __future__ import annotations

import pytest

from validation.timing.contestants.generated import casadi_loops, sympy_loops
from validation.timing.contestants.symofros import our_loops
from validation.timing.race import error
from validation.timing.task import task

FUNCTIONS = (
    "mass_matrix",
    "bias",
    "dynamics",
    "inverse_dynamics",
    "forward_dynamics",
    "frame_jacobian",
    "inverse_dynamics_derivatives",
    "forward_dynamics_derivatives",
    "inverse_dynamics_second_derivatives",
    "inverse_dynamics_vjp",
    "forward_dynamics_vjp",
)
# Rounding of a solve is amplified by the condition of M.
TOLERANCE = {"forward_dynamics": 1e-11, "forward_dynamics_derivatives": 1e-11, "forward_dynamics_vjp": 1e-11}


# In every run one function: derivatives take four compilations of five times the text, each by two compilers.
FEW = ("dynamics",)
SLOW = pytest.mark.slow


@pytest.mark.parametrize(
    ("peer", "label", "names"),
    [
        ("casadi", "planar2R", FEW),
        ("sympy", "planar2R", FEW),
        pytest.param("casadi", "planar2R", FUNCTIONS, marks=SLOW),
        pytest.param("casadi", "panda", ("dynamics", "frame_jacobian"), marks=SLOW),
        pytest.param("sympy", "planar3R", ("mass_matrix", "bias", "dynamics", "forward_dynamics"), marks=SLOW),
    ],
)
def test_code_generated_by_casadi_and_sympy_agrees_with_ours(peer: str, label: str, names: tuple[str, ...]) -> None:
    """The same loops that are timed; derivatives, too."""
    given = task(label, 12)
    ours = {loop.function: loop for loop in our_loops(given, names) if loop.variant == "symofros"}
    theirs = list({"casadi": casadi_loops, "sympy": sympy_loops}[peer](given, names))
    assert len(theirs) >= 2 * len(names), "two builds by each compiler"
    for loop in theirs:
        off = error(loop.results(), ours[loop.function].results())
        assert off < TOLERANCE.get(loop.function, 1e-12), (loop.function, loop.variant)
