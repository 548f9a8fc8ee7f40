"""Models that answer on tape while C is compiled: bits stay, the compiled model is asked for."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from reference_models import load_model
from symofros.runtime.build import prebuilt, toolchain
from symofros.runtime.build.toolchain import find_toolchain
from symofros.runtime.calls import tape

BACKGROUND = sf.Options(background=True)


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache without models; the tape machine stays loaded."""
    sf.compile(load_model("pendulum"), sf.Options(backend="tape")).mass_matrix([0.0])
    monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


def test_a_model_answers_on_tape_until_it_is_asked_for_the_compiled_one(cache: Path, rng: np.random.Generator) -> None:
    s = load_model("four_bar")
    model, twin = sf.compile(s, BACKGROUND), sf.compile(s, sf.Options(backend="tape"))
    q, v = twin.random_state(rng)
    M, expected = model.mass_matrix(q), twin.mass_matrix(q)
    np.testing.assert_array_equal(M, expected)
    assert not model.libraries
    compiled = model.ready()
    assert compiled.libraries and compiled.ready() is compiled
    np.testing.assert_allclose(compiled.mass_matrix(q), M, rtol=1e-13)
    np.testing.assert_array_equal(model.mass_matrix(q), expected)  # The first one stays as it is.
    again = sf.compile(s, BACKGROUND)
    np.testing.assert_array_equal(again.mass_matrix(q), compiled.mass_matrix(q))
    assert again.libraries == compiled.libraries and again.ready() is again


def test_the_compiled_model_has_the_settings_of_the_first(cache: Path) -> None:
    s = sf.System(
        "one",
        [sf.RigidBody("arm", sf.Joint("hinge", "revolute"), sf.Inertia("m", (0.1, 0, 0), (0.1, 0.1, 0.1)))],
        [sf.Parameter("m", 2.0)],
    )
    first = sf.compile(s, BACKGROUND).with_parameters(m=3.0).with_threads(2)
    first.mass_matrix([0.3])
    compiled = first.ready()
    assert compiled.parameters == {"m": 3.0} and compiled.threads == 2
    assert compiled.libraries
    assert pickle.loads(pickle.dumps(first)).parameters == {"m": 3.0}
    with pytest.raises(sf.ParameterError):
        compiled.with_parameters(m=-1.0)
    unchecked = sf.compile(s, BACKGROUND).with_parameter_checks(False)
    assert unchecked.ready().with_parameters(m=-1.0).parameters == {"m": -1.0}


def test_a_failure_of_the_compiler_is_raised_by_ready(cache: Path) -> None:
    model = sf.compile(load_model("pendulum"), sf.Options(background=True, flags=("-no-such-flag",)))
    assert np.isfinite(model.mass_matrix([0.2])).all()
    with pytest.raises(sf.CompileError, match="no-such-flag"):
        model.ready()


def test_without_a_compiler_the_libraries_of_the_wheel_serve(
    cache: Path, monkeypatch: pytest.MonkeyPatch, rng: np.random.Generator
) -> None:
    """Models on tape, with a word; the same bits as where the machine is compiled here."""
    s = load_model("heavy_top")
    expected = sf.compile(s, sf.Options(backend="tape"))
    q, v = expected.random_state(rng)
    accelerations = expected.forward_dynamics(q, v, [])
    monkeypatch.setattr(tape, "machine_library", lambda source, flags: pytest.fail("it is loaded already"))
    monkeypatch.setattr("symofros.compiler.prebuilt_library", lambda source: cache / "brought.so")
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setattr(toolchain.shutil, "which", lambda name: None)
    monkeypatch.setattr(toolchain.importlib.util, "find_spec", lambda name: None)
    find_toolchain.cache_clear()
    try:
        with pytest.warns(sf.CompilerMissingWarning, match="interpreted in C, several times slower"):
            model = sf.compile(s)
        np.testing.assert_array_equal(model.forward_dynamics(q, v, []), accelerations)
        with pytest.raises(sf.CompileError, match="no C compiler"):
            prebuilt.machine_library("int unknown;", ())
    finally:
        find_toolchain.cache_clear()


def test_a_library_of_another_text_is_not_loaded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(prebuilt, "files", lambda package: tmp_path)
    (tmp_path / prebuilt.FOLDER).mkdir()
    (tmp_path / prebuilt.FOLDER / prebuilt.prebuilt_name("int one;")).write_bytes(b"")
    assert prebuilt.prebuilt_library("int one;") is not None
    assert prebuilt.prebuilt_library("int two;") is None
