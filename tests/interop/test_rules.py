"""What frameworks are refused, in words."""

from __future__ import annotations

import re
import subprocess
import sys
from typing import Any

import pytest

import symofros as sf
from symofros.base.functions import FUNCTIONS
from symofros.interop import rules
from symofros.interop.wrapped import WrappedDynamics
from tests.models import model


def test_importing_interop_loads_no_framework() -> None:
    code = (
        "import sys, symofros; symofros.interop; print(*({'torch', 'jax', 'casadi', 'gymnasium'} & set(sys.modules)))"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "\n"


def test_a_missing_framework_is_reported_with_the_remedy() -> None:
    with pytest.raises(sf.SymofrosError, match=r"pip install 'symofros\[torch\]'"):
        rules.framework("a_package_that_nobody_has", "torch")


@pytest.mark.parametrize("force", ["sin(t)", "max(t - 100, 0)", "t*(t - 0.7310585)*(t - 19.47)"])
def test_forces_that_depend_on_time_are_refused(force: str) -> None:
    """Also those that are the same at any few instants."""
    joint = sf.Joint("x", "prismatic", axis=(1, 0, 0), effort=(force,))
    pushed = sf.System("pushed", [sf.RigidBody("cart", joint, sf.Inertia(2.0))])
    with pytest.raises(sf.SymofrosError, match="depend on the time"):
        rules.check_model(sf.compile(pushed))


def test_prescribed_motions_are_refused() -> None:
    driven = sf.Joint("x", "prismatic", axis=(1, 0, 0), prescribed=True)
    swing = sf.Joint("q", "revolute", "cart", axis=(0, 1, 0))
    system = sf.System(
        "driven",
        [sf.RigidBody("cart", driven, sf.Inertia(2.0)), sf.RigidBody("bob", swing, sf.Inertia(1.0, (0, 0, -0.5)))],
    )
    with pytest.raises(sf.SymofrosError, match="prescribe motion"):
        rules.check_model(sf.compile(system))


def test_functions_of_rigid_contacts_are_refused() -> None:
    """They have no contact forces: a ball falls through its floor."""
    ball = sf.RigidBody("ball", sf.Joint("z", "prismatic", axis=(0, 0, 1)), sf.Inertia(1.0))
    floor = sf.Contact("floor", ("ball", None), ("world", None), radius=0.1, restitution=0.5)
    record = sf.compile(sf.System("bouncing", [ball], connections=[floor])).record
    rules.check_record(record)
    with pytest.raises(sf.SymofrosError, match="rigid contacts: floor"):
        rules.check_functions(record)


def test_functions_of_friction_that_sticks_are_refused() -> None:
    """They take it as smooth: a joint that runs hold creeps."""
    joint = sf.Joint("s", "prismatic", axis=(1, 0, 0), elements=(sf.Friction(6.0, sticks=True),))
    record = sf.compile(sf.System("block", [sf.RigidBody("block", joint, sf.Inertia(2.0))])).record
    rules.check_record(record)
    with pytest.raises(sf.SymofrosError, match="friction that sticks: s(.|\n)*sticks=False"):
        rules.check_functions(record)


def test_states_of_forces_are_refused_as_functions_are_made() -> None:
    """They were refused at the first call, in words that had no remedy."""
    joint = sf.Joint("s", "prismatic", axis=(1, 0, 0), elements=(sf.LuGre(6.0, stiffness=4e3, damping=6.0),))
    sliding = sf.compile(sf.System("block", [sf.RigidBody("block", joint, sf.Inertia(2.0))]))
    with pytest.raises(sf.SymofrosError, match=r"states of forces(.|\n)*s\.bristle(.|\n)*Dynamics\(model\.carried\)"):
        Wrapped(sliding, None)  # type: ignore[arg-type]
    assert Wrapped(sliding.carried, None).model.nv == 2  # type: ignore[arg-type]


class Wrapped(WrappedDynamics):
    """Of no framework."""

    def _apply(self, name: str, *arrays: Any) -> Any:
        raise NotImplementedError

    def _given(self, function: str, **given: Any) -> list[Any]:
        raise NotImplementedError


def test_a_model_in_place_of_its_system_is_named() -> None:
    """JAX and PyTorch take a model, CasADi a system: "build a sf.System" was the remedy."""
    with pytest.raises(sf.DescriptionError, match="that the model was compiled from"):
        sf.compile(model("double_pendulum"))  # type: ignore[arg-type]


@pytest.mark.parametrize("function", rules.RULES)
def test_suggested_second_derivatives_exist_for_the_same_function(function: str) -> None:
    """The methods and functions that the remedy names are the model's."""
    m = model("double_pendulum")
    remedy = str(rules.second_derivatives(m, function))
    assert re.findall(r"evaluate\('(\w+)'", remedy) == [f"{function}_hessian"]
    assert f"{function}_hessian" in FUNCTIONS
    others = [name for name in re.findall(r"model\.(\w+)\(", remedy) if name != "evaluate"]
    assert others == [name for name in (f"{function}_hvp",) if hasattr(m, name)]
