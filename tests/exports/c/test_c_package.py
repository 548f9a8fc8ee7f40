"""The C package: strict C99 under two compilers, the same motion as Python, clean under every checker."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path
from string import Template

import numpy as np
import pytest

import symofros as sf
from tests.exports.cases import (
    MODELS,
    PLANAR,
    STARTS,
    STEP,
    STRICT,
    build,
    need,
    relative,
    run,
    sanitizers,
    sources,
    system_of,
    trajectory,
)
from tests.models import sampled

HERE = Path(__file__).parent
# The same steps in the same order, compiled with other flags: fused products round differently.
SAME = 1e-12


@pytest.fixture(scope="module", params=sampled(MODELS, ("four_bar",)))
def package(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[str, Path]:
    name = request.param
    folder = tmp_path_factory.mktemp("package") / name
    sf.export(system_of(name), "c", folder, start=STARTS[name], dt=STEP[name])
    return name, folder


def last_state(text: str) -> dict[str, np.ndarray]:
    lines = [line.split() for line in text.splitlines()]
    return {words[0]: np.array(list(map(float, words[1:]))) for words in lines if words[0] in ("selftest", "q", "v")}


def check(name: str, text: str, t_end: float = 0.2) -> None:
    found, wanted = last_state(text), trajectory(name, t_end)
    assert found["selftest"][0] < 1e-11
    assert relative(found["q"], wanted.q[-1]) < SAME
    assert relative(found["v"], wanted.v[-1]) < SAME


def test_strict_c_moves_as_python_does(package: tuple[str, Path]) -> None:
    name, folder = package
    build(folder, "../example")
    check(name, run("../example", "0.2", str(STEP[name]), "--fast", cwd=folder))


@pytest.fixture
def four_bar(tmp_path: Path) -> Path:
    sf.export(system_of("four_bar"), "c", tmp_path, start=STARTS["four_bar"])
    return tmp_path


def test_chosen_functions_are_exported_with_those_needed_for_stepping(tmp_path: Path) -> None:
    """A fraction of the text, which builds, checks itself and moves as the whole package does."""
    asked = ("gravity_force", "inverse_dynamics", "frame_pose")
    system = system_of("four_bar")
    whole = sf.export(system, "c", tmp_path / "whole").folder
    done = sf.export(system, "c", tmp_path / "c", functions=asked)
    text = (done.folder / "four_bar.c").read_text()
    written = set(re.findall(r'^    \{"(\w+)", (?:NULL|"\w+"), \d', text, re.MULTILINE))
    assert written == {*asked, "forward_dynamics", "project"}
    assert len(text) < 0.7 * len((whole / "four_bar.c").read_text())
    assert "four_bar_gravity_force" in (done.folder / "README.md").read_text()
    build(done.folder, "example")
    assert last_state(run("./example", "0.2", "0.001", "--fast", cwd=done.folder))["selftest"][0] < 1e-9
    with pytest.raises(sf.UnknownNameError, match=r"no function 'gravity'.*\n.*\n.*\n.*gravity_force"):
        sf.export(system, "c", tmp_path / "other", functions=["gravity"])


def test_the_example_refuses_invalid_arguments(four_bar: Path) -> None:
    build(four_bar, "example")
    for arguments in (["x"], ["1", "0.1x"], ["1", "0.1", "2"], ["--quick"], ["nan"], ["1", "0"], ["-1"]):
        done = subprocess.run(["./example", *arguments], cwd=four_bar, capture_output=True, text=True)
        assert done.returncode == 2, arguments
        assert done.stderr == "usage: four_bar_example [SECONDS [PERIOD]] [--fast]\n"


def test_a_sign_error_fails_the_selftest(four_bar: Path) -> None:
    """One sign in the equations, and the package says so."""
    text = (four_bar / "four_bar.c").read_text()
    at = text.index(" - ", text.index("static void four_bar_bias"))
    (four_bar / "four_bar.c").write_text(text[:at] + " + " + text[at + 3 :])
    build(four_bar, "example")
    done = subprocess.run(["./example", "0", "--fast"], cwd=four_bar, capture_output=True, text=True)
    assert done.returncode == 1
    assert last_state(done.stdout)["selftest"][0] > 1e-3


def test_models_that_lack_functions_of_their_method_are_refused(four_bar: Path) -> None:
    """By one function after the other, for every method; what the package lacks of itself makes no difference."""
    text = Template((HERE / "partial.c.in").read_text()).substitute(name="four_bar")
    (four_bar / "partial.c").write_text(text)
    build(four_bar, "partial", *(name for name in sources(four_bar) if name != "example.c" and name != "main.c"))
    written = set(re.findall(r'^    \{"(\w+)", NULL, \d', (four_bar / "four_bar.c").read_text(), re.MULTILINE))
    called = {  # SYM_METHOD_... of symofros_stepper.h -> what its steps call
        0: {"forward_dynamics", "project"},
        1: {"forward_dynamics", "project"},
        2: {"forward_dynamics", "project", "implicit_terms"},
        3: {"forward_dynamics", "project", "implicit_terms", "residual"},
        4: {"forward_dynamics", "project", "implicit_terms", "momentum"},
    }
    for method, functions in called.items():
        absent = functions - written
        for name in ("", "forward_dynamics", "project", "implicit_terms", "residual", "momentum"):
            wanted = "refused" if absent or name in functions else "made"
            assert run("./partial", str(method), name, cwd=four_bar).split() == [wanted], (method, name)


def test_the_package_has_no_writable_global_memory(four_bar: Path) -> None:
    """No globals: neither data nor zeroed memory in any part but the example."""
    for source in sources(four_bar):
        run("gcc", "-std=c99", "-O0", "-c", source, "-o", f"{source}.o", cwd=four_bar)
        lines = [line.split() for line in run("size", "-A", f"{source}.o", cwd=four_bar).splitlines()]
        # .data.rel.ro holds pointers that the loader fills in and then protects.
        written = {words[0]: int(words[1]) for words in lines if words and words[0] in (".data", ".bss")}
        assert written == {".data": 0, ".bss": 0}, source


@pytest.mark.tools
def test_cmake_builds_tests_and_installs_the_package(package: tuple[str, Path], tmp_path: Path) -> None:
    need("cmake", "pkg-config")
    name, folder = package
    run("cmake", "-S", folder, "-B", tmp_path / "build", f"-DCMAKE_INSTALL_PREFIX={tmp_path}/usr", cwd=tmp_path)
    run("cmake", "--build", tmp_path / "build", cwd=tmp_path)
    run("ctest", "--test-dir", tmp_path / "build", cwd=tmp_path)
    run("cmake", "--install", tmp_path / "build", cwd=tmp_path)
    (found,) = (tmp_path / "usr").rglob("*.pc")
    (tmp_path / "user.c").write_text(
        f'#include "{name}.h"\nint main(void) {{ return {name}_selftest() < 1e-9 ? 0 : 1; }}\n'
    )
    flags = f"$(PKG_CONFIG_PATH={found.parent} pkg-config --cflags --libs {name})"
    run("bash", "-c", f"gcc user.c {flags} -o user && ./user", cwd=tmp_path)


@pytest.mark.tools
@pytest.mark.parametrize("checker", ["address,undefined", "thread", "valgrind"])
def test_two_models_run_in_threads_under_sanitizers_and_valgrind(tmp_path: Path, checker: str) -> None:
    need("clang", "valgrind")
    for name, system in (("planar", PLANAR), ("four_bar", system_of("four_bar"))):
        sf.export(system, "c", tmp_path / name, start=STARTS.get(name), frames=[])
    text = Template((HERE / "threads.c.in").read_text()).substitute(first="planar", second="four_bar")
    (tmp_path / "threads.c").write_text(text)
    files = [tmp_path / n / f"{n}{part}.c" for n in ("planar", "four_bar") for part in ("", "_plant", "_selftest")]
    flags = ["-g", "-O1", *STRICT, "-D_POSIX_C_SOURCE=200809L", "-Iplanar", "-Ifour_bar", "-pthread"]
    if checker == "valgrind":
        run("gcc", *flags, "-o", "threads", "threads.c", *files, "four_bar/symofros_stepper.c", "-lm", cwd=tmp_path)
        out = run("valgrind", "--error-exitcode=9", "--leak-check=full", "-q", "./threads", cwd=tmp_path)
    else:
        run(
            "clang",
            *flags,
            *sanitizers("clang", checker),
            "-o",
            "threads",
            "threads.c",
            *files,
            "four_bar/symofros_stepper.c",
            "-lm",
            cwd=tmp_path,
        )
        out = run("./threads", cwd=tmp_path)
    assert out == "0 bad\n"


@pytest.mark.tools
def test_clang_compiles_without_warnings(package: tuple[str, Path]) -> None:
    need("clang")
    name, folder = package
    run("clang", *STRICT, "-O2", "-o", "../clang", *sources(folder), "-lm", cwd=folder)
    check(name, run("../clang", "0.2", str(STEP[name]), "--fast", cwd=folder))


BODY = sf.RigidBody("b", sf.Joint("j", "revolute"), sf.Inertia(1.0, (1, 0, 0), (1, 1, 1)))
DRIVEN = sf.RigidBody("b", sf.Joint("j", "revolute", prescribed=True), sf.Inertia(1.0, (1, 0, 0), (1, 1, 1)))


@pytest.mark.parametrize(
    ("name", "body"), [pytest.param("no_inputs", BODY, marks=pytest.mark.slow), ("no_states", DRIVEN)]
)
def test_models_without_inputs_or_states_are_exported(tmp_path: Path, name: str, body: sf.RigidBody) -> None:
    sf.export(sf.System(name, (body,)), "c", tmp_path)
    flags = (*STRICT, "-O0", "-g", *sanitizers("gcc", "undefined,address"))
    run("gcc", *flags, "-o", "example", *sources(tmp_path), "-lm", cwd=tmp_path)
    assert "selftest" in run("./example", "0.01", "--fast", cwd=tmp_path)


@pytest.mark.parametrize("method", ["semi_implicit_euler", "dopri5", "rodas4", "generalized_alpha", "implicit_euler"])
def test_packages_of_other_methods_step_the_four_bar(tmp_path: Path, method: str) -> None:
    """The four-bar, by every kind of loop; adaptive ones within their bound."""
    sf.export(system_of("four_bar"), "c", tmp_path, start=STARTS["four_bar"], method=method, frames=[])
    build(tmp_path, "example")
    found = last_state(run("./example", "0.2", "0.001", "--fast", cwd=tmp_path))
    assert relative(found["q"], trajectory("four_bar", 0.2).q[-1]) < (1e-2 if "euler" in method else 1e-5)


def test_directional_derivatives_pass_sanitizers(tmp_path: Path) -> None:
    """Along quaternions of a prescribed ball joint, too, whose lengths are taken out of what they change."""
    ball = sf.Joint("ball", "ball", prescribed=True)
    hinge = sf.Joint("hinge", "revolute", "base", "end", axis=(0, 1, 0), actuated=True)
    bodies = (
        sf.RigidBody("base", ball, sf.Inertia(1.0, (0.1, 0, 0), (1, 1, 1)), (sf.Frame("end", (0.5, 0, 0)),)),
        sf.RigidBody("arm", hinge, sf.Inertia(1.0, (0.3, 0, 0.1), (0.1, 0.2, 0.2))),
    )
    sf.export(sf.System("driven", bodies), "c", tmp_path)
    (tmp_path / "main.c").write_text((HERE / "directional.c").read_text())
    flags = (*STRICT, "-O0", "-g", *sanitizers("gcc", "undefined,address"))
    run("gcc", *flags, "-o", "directional", *sources(tmp_path), "-lm", cwd=tmp_path)
    assert float(run("./directional", cwd=tmp_path)) < 1e-6
