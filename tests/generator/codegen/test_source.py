"""The C text: strict C99 without warnings, legal names, one exported symbol, no state."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Literal

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.base.c_text import c_string
from symofros.base.functions import DEFAULT_FRAME_FUNCTIONS, DEFAULT_FUNCTIONS, FRAME_FUNCTIONS, MODEL_FUNCTIONS
from symofros.base.names import identifier, local_name
from symofros.compiler import Compilation
from symofros.description.joints.joint_kinds import JOINT_KINDS
from symofros.native import native_text
from tests.models import sampled, system

COMPILERS = [name for name in ("gcc", "clang") if shutil.which(name)]
STRICT = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Wconversion", "-Werror", "-O1"]


def source_of(stated: sf.System) -> str:
    """Every function but derivatives, which compile for long and are built on a small mechanism below."""
    every = DEFAULT_FUNCTIONS + DEFAULT_FRAME_FUNCTIONS
    functions = [name for name in every if "derivative" not in name and "by_par" not in name]
    return source_of_functions(stated, tuple(functions))


def compile_strictly(folder: Path, source: str, compiler: str, *more: str) -> Path:
    (folder / "symofros_model.h").write_text(native_text("model/symofros_model.h"))
    (folder / "model.c").write_text(source)
    done = subprocess.run(
        [compiler, *STRICT, *more, "-c", "model.c", "-o", "model.o"], cwd=folder, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr[:2000]
    return folder / "model.o"


def every_joint() -> sf.System:
    """Each kind of joint on the ground, with parameters: all that C text may hold, in little of it."""
    solid = sf.Inertia("m", (0.1, -0.2, 0.05), (0.3, 0.4, 0.5))
    axis = {"axis": (0, 0.6, 0.8), "axis2": (1, 0, 0), "pitch": 0.2}
    joints = [sf.Joint(f"j_{kind}", kind, **axis) for kind in JOINT_KINDS if kind != "general"]
    turned = {
        "coordinates": ("a", "b"),
        "moving_position": ("a", "sin(b)", 0),
        "moving_rotation": sf.Rotation.rpy(0, 0, "b"),
    }
    joints.append(sf.Joint("j_general", "general", **turned))
    bodies = [sf.RigidBody(f"b{i}", joint, solid, [sf.Frame("tip", (0.1, 0, "m"))]) for i, joint in enumerate(joints)]
    return sf.System("every_joint", bodies, [sf.Parameter("m", 1.5)])


@pytest.mark.parametrize("compiler", sampled(COMPILERS, COMPILERS[:1]))
@pytest.mark.parametrize("case", ["every joint", *sampled(("tree0", "tree5", "parametrised2"), ())])
def test_source_compiles_as_strict_c99(case: str, compiler: str, tmp_path: Path) -> None:
    compile_strictly(tmp_path, source_of(every_joint() if case == "every joint" else system(case)), compiler)


@pytest.mark.parametrize("compiler", sampled(COMPILERS, COMPILERS[:1]))
@pytest.mark.parametrize("form", sampled(("multipliers", "null_space"), ("multipliers",)))
def test_derivatives_and_solvers_build_as_strict_c99(
    form: Literal["multipliers", "null_space"], compiler: str, tmp_path: Path
) -> None:
    options = sf.Options(functions=MODEL_FUNCTIONS + FRAME_FUNCTIONS, constraints=form)
    compile_strictly(tmp_path, Compilation(MODELS["slider_crank"], options).source(), compiler)


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("nm") is None, reason="needs binutils")
def test_the_library_exports_one_symbol_and_keeps_no_state(tmp_path: Path) -> None:
    done = compile_strictly(tmp_path, source_of(MODELS["friction_arm"]), COMPILERS[0])
    symbols = subprocess.run(["nm", str(done)], capture_output=True, text=True).stdout.splitlines()
    exported = [line.split()[-1] for line in symbols if re.search(r" [A-TV-Z] ", line)]
    assert exported == ["friction_arm_model"]
    writable = [line for line in symbols if re.search(r" [bBdDcC] ", line) and "rel.ro" not in line]
    # Tables of pointers are constant; a position-dependent object keeps them in .data.rel.ro, which nm shows as d.
    assert all(
        re.search(r"(_(names|in|out|functions|struct|default|neutral)| measures\.\d+)$", line) for line in writable
    ), writable


@pytest.mark.parametrize(
    "name", ["arm", "7dof arm", "int", "größe", "a*/b", 'quote"back\\slash', "x" * 150, "?" + "?/", "main"]
)
def test_any_name_gives_a_legal_c_identifier(name: str, tmp_path: Path) -> None:
    body = sf.RigidBody(
        f"body {name}",
        sf.Joint(f"joint {name}", "revolute"),
        sf.Inertia(1.0, (0.1, 0, 0), (1, 1, 1)),
        [sf.Frame(f"frame {name}")],
    )
    stated = sf.System(name, [body])
    compile_strictly(tmp_path, source_of_functions(stated, ("mass_matrix", "frame_pose")), COMPILERS[0])
    model = sf.compile(stated)
    assert model.names.q == (f"joint {name}",)
    assert model.mass_matrix([0.0]).shape == (1, 1)


WORDS_OF_C = (
    *("int", "double", "while", "restrict", "main", "NULL", "sym_model", "_t", "EOF"),
    *("M", "q", "v", "u", "par", "pre", "h"),
)


def test_parameters_inputs_and_coordinates_may_be_words_of_c() -> None:
    """All name another thing in turn; what the C computes does not depend on what its things are called."""
    count = len(WORDS_OF_C)
    numbers, zeros = np.arange(1.0, count + 1), np.zeros(count)

    def slider(i: int, mass: str = "2", effort: str = "0") -> sf.RigidBody:
        inertia = sf.Inertia(mass, (0.1, 0, 0), (1, 1, 1))
        return sf.RigidBody(f"b{i}", sf.Joint(f"x_{i}", "prismatic", effort=(effort,)), inertia)

    as_parameters = sf.System(
        "while",
        [slider(i, mass=f"2*{name}") for i, name in enumerate(WORDS_OF_C)],
        [sf.Parameter(name, number) for name, number in zip(WORDS_OF_C, numbers, strict=True)],
    )
    np.testing.assert_array_equal(sf.compile(as_parameters).mass_matrix(zeros), np.diag(2 * numbers))
    as_inputs = sf.System(
        "double",
        [slider(i, effort=f"3*{name}") for i, name in enumerate(WORDS_OF_C)],
        inputs=[sf.Input(name) for name in WORDS_OF_C],
    )
    np.testing.assert_array_equal(sf.compile(as_inputs).generalized_force(zeros, zeros, numbers), 3 * numbers)
    as_coordinates = sf.System(
        "restrict",
        [
            sf.RigidBody(
                name,
                sf.Joint(name, "prismatic", effort=(f"-3*{name} - d{name}",)),
                sf.Inertia(2.0, (0.1, 0, 0), (1, 1, 1)),
                [sf.Frame(f"{name}_tip")],
            )
            for name in WORDS_OF_C
        ],
    )
    forces = sf.compile(as_coordinates).generalized_force(numbers, 2 * numbers, [])
    np.testing.assert_array_equal(forces, -5 * numbers)


def test_names_are_readable() -> None:
    assert identifier("SSRMS arm") == "SSRMS_arm"
    assert identifier("2R") == "m2R"
    assert identifier("double") == "double_"
    assert identifier("äöü") == "model"
    assert local_name("w_WL_L[forearm][2]", 41) == "w_WL_L__forearm_2_41"
    assert c_string('a"\\?é') == '"a\\042\\134\\077\\303\\251"'


def source_of_functions(stated: sf.System, functions: tuple[str, ...]) -> str:
    return Compilation(stated, sf.Options(functions=functions)).source()


# Forces that use every row of the table of operations, of two inputs and a parameter.
FORMULAS = (
    "sin(u1) + cos(2e5*u2)",
    "tan(u1)*asin(u2/4)",
    "acos(u2/4) - atan(u1)",
    "atan2(u1, u2)",
    "sqrt(abs(u1))",
    "exp(u1)/log(2 + abs(u2))",
    "sinh(u1) - cosh(u2) - tanh(u1)",
    "min(u1, u2) - max(u1, -u2)",
    "sign(u1)*u2",
    "abs(u1)^1.7 + u1^3 - u2^(-2) + 1.5^u2",
    "max(u1, 1)*min(k, u2) + k^u1",
    "-(u1 - u2) - (u1 - (u2 - 1))",
    "u1/(u2/(u1*u2 + 3))",
    "(u1 + u2)*(u1 - u2)/u2",
    "2*u1 - 3*(u2*4)",
    "-u1*-u2 - -sin(-u1)",
    "k",
    "atan2(1, u1)",
    "-u1 - k*(2 - u2)",
)
OPERATIONS = sf.System(
    "operations",
    [
        sf.RigidBody(f"b{i}", sf.Joint(f"x{i}", "prismatic", effort=(text,)), sf.Inertia(1.0, (0, 0, 0), (1, 1, 1)))
        for i, text in enumerate(FORMULAS)
    ],
    [sf.Parameter("k", 0.7)],
    inputs=[sf.Input("u1"), sf.Input("u2")],
)


def test_printed_operations_match_interpreter_and_python() -> None:
    """Compiled, interpreted, and as Python makes of the same text."""
    u = np.random.default_rng(0).uniform(-3, 3, (200, 2))
    zero = np.zeros(len(FORMULAS))
    exact = sf.compile(OPERATIONS, sf.Options(flags=("-O2", "-ffp-contract=off")))
    expected = sf.compile(OPERATIONS, sf.Options(backend="interpreter")).generalized_force(zero, zero, u)
    assert np.array_equal(exact.generalized_force(zero, zero, u), expected)
    names = {name: getattr(np, name) for name in ("sin", "cos", "tan", "sqrt", "exp", "log", "sign")}
    names |= {"asin": np.arcsin, "acos": np.arccos, "atan": np.arctan, "atan2": np.arctan2, "abs": abs, "k": 0.7}
    names |= {"sinh": np.sinh, "cosh": np.cosh, "tanh": np.tanh, "min": min, "max": max}
    for i, formula in enumerate(FORMULAS):
        for (u1, u2), value in zip(u[:20], expected[:20, i], strict=True):
            python = eval(formula.replace("^", "**"), {}, names | {"u1": u1, "u2": u2})
            assert value == pytest.approx(python, rel=1e-13, abs=1e-13), formula


def test_generated_text_does_not_depend_on_hash_order() -> None:
    """Whatever the order in which a process keeps its sets of names: libraries are known by their text."""
    program = (
        "import hashlib, symofros as sf; from tests.generator.codegen.test_source import source_of_functions;"
        "joint = sf.Joint('q', 'revolute', effort=('b*a - c*(a + q) - (d*c - b*q)',));"
        "inputs = [sf.Input(name) for name in 'abcd'];"
        "body = sf.RigidBody('body', joint, sf.Inertia(1.0, (0, 0, 0), (1, 1, 1)));"
        "text = source_of_functions(sf.System('s', [body], inputs=inputs), ('generalized_force',));"
        "print(hashlib.sha256(text.encode()).hexdigest())"
    )
    said = {
        subprocess.run(
            [sys.executable, "-c", program],
            cwd=Path(__file__).parents[3],
            env=os.environ | {"PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in ("1", "2")
    }
    assert len(said) == 1


def test_each_function_begins_with_the_users_names_of_its_inputs() -> None:
    solid = sf.Inertia("m", (0.1, 0, 0), (1, 1, 1))
    boom = sf.RigidBody("boom", sf.Joint("shoulder", "revolute", effort=("pump*m",)), solid)
    crane = sf.System("crane", [boom], [sf.Parameter("m", 3.0)], inputs=[sf.Input("pump")])
    text = source_of_functions(crane, ("dynamics",))
    parameters = "/* parameters -> pre, all that depends on them alone\n *   par[0] m\n *   pre[0..1] of m\n */\n"
    assert f"{parameters}static void crane_init_0(" in text
    names = " *   q[0] shoulder\n *   v[0] shoulder\n *   u[0] pump\n"
    legend = f"/* dynamics: M, h and Q in one call\n{names} *   -> M[1 x 1] by rows, h[1], Q[1]\n */\n"
    assert f"{legend}static void crane_dynamics" in text


def test_names_cannot_close_c_comments() -> None:
    solid = sf.Inertia(1.0, (0.1, 0, 0), (1, 1, 1))
    text = source_of_functions(sf.System("s", [sf.RigidBody("b", sf.Joint("a */ b", "revolute"), solid)]), ("bias",))
    assert " *   q[0] a * / b\n" in text
