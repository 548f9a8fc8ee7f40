"""Where an export may be written, what it may be called, and what it says when it may not."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import symofros as sf
from reference_models import MODELS
from symofros.base.names import identifier, package_name
from symofros.exports.folder import MANIFEST, check_same, write_folder

PENDULUM = MODELS["pendulum"]


def test_a_folder_with_foreign_files_is_not_overwritten(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("years of work")
    with pytest.raises(sf.ExportError, match=r"not overwritten[\s\S]*thesis.tex[\s\S]*choose another folder"):
        sf.export(PENDULUM, "c", tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]


@pytest.mark.parametrize("text", ["", "{}", "[]", '{"files": 3}', "\0"])
def test_a_foreign_manifest_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / MANIFEST).write_text(text)
    with pytest.raises(sf.ExportError, match="that we did not write"):
        sf.export(PENDULUM, "urdf", tmp_path)


def test_a_manifest_cannot_remove_files_elsewhere(tmp_path: Path) -> None:
    (tmp_path / "precious").write_text("x")
    folder = tmp_path / "out"
    folder.mkdir()
    (folder / MANIFEST).write_text(json.dumps({"files": {"../precious": "0"}}))
    sf.export(PENDULUM, "urdf", folder)
    assert (tmp_path / "precious").read_text() == "x"


def test_exports_replace_exports(tmp_path: Path) -> None:
    sf.export(PENDULUM, "c", tmp_path)
    (tmp_path / "build").mkdir()  # What a user's build adds stays.
    done = sf.export(PENDULUM, "urdf", tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {"pendulum.urdf", MANIFEST, "build"}
    assert done.files == (tmp_path / "pendulum.urdf",)


def test_files_changed_by_hand_are_kept(tmp_path: Path) -> None:
    sf.export(PENDULUM, "c", tmp_path)
    (tmp_path / "main.c").write_text("mine")
    with pytest.raises(sf.ExportError, match="changed since it was exported"):
        sf.export(PENDULUM, "c", tmp_path)
    assert (tmp_path / "main.c").read_text() == "mine"


def test_a_new_file_never_lands_on_a_users_own(tmp_path: Path) -> None:
    write_folder(tmp_path, "c", "a", {"a.c": "1"}, "test")
    (tmp_path / "b.c").write_text("mine")
    with pytest.raises(sf.ExportError, match=r"b\.c"):
        write_folder(tmp_path, "c", "b", {"b.c": "2"}, "test")
    assert (tmp_path / "b.c").read_text() == "mine"


@pytest.mark.parametrize(
    "name", ["sym", "math", "double", "symofros_model", "fmi2Functions", "end", "CON", "sym_x", "3R"]
)
def test_reserved_names_become_other_identifiers(name: str) -> None:
    """Of C, its headers, Windows, FMI, Matlab, and ours."""
    called = identifier(name)
    assert called != name
    assert called.isidentifier()


@pytest.mark.parametrize("name", ["test", "All", "clean", "pi", "i", "sin", "step", "error", "which"])
def test_exports_have_no_name_that_cmake_or_matlab_uses(name: str, tmp_path: Path) -> None:
    """CMake refused a target "test"; on Matlab's path a MEX file "pi" took the place of the number."""
    system = sf.System(name, PENDULUM.bodies, PENDULUM.parameters)
    called = sf.export(system, "mex", tmp_path).name
    assert called == package_name(name) == f"{name}_" != identifier(name)


def test_invalid_arguments_of_export_are_refused(tmp_path: Path) -> None:
    with pytest.raises(sf.ArgumentError, match="did you mean 'fmu"):
        sf.export(PENDULUM, "fmu1", tmp_path)  # type: ignore[arg-type]
    with pytest.raises(sf.UnknownNameError, match="no coordinate or speed 'q7'"):
        sf.export(PENDULUM, "c", tmp_path, start={"q7": 1.0})
    with pytest.raises(sf.UnknownNameError, match="no frame 'nowhere'"):
        sf.export(PENDULUM, "c", tmp_path, outputs=["nowhere"])
    with pytest.raises(sf.UnknownNameError, match="no method 'cvode'"):
        sf.export(PENDULUM, "c", tmp_path, method="cvode")
    with pytest.raises(sf.ExportError, match="dt is not positive"):
        sf.export(PENDULUM, "c", tmp_path, dt=0.0)
    assert not any(tmp_path.iterdir())


def test_a_failing_compiler_is_quoted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from symofros.exports.c import compiling
    from symofros.runtime.build.toolchain import Toolchain

    monkeypatch.setattr(compiling, "find_toolchain", lambda _: Toolchain(("gcc", "-Dnq=1/0/"), "gcc"))
    with pytest.raises(sf.CompileError, match=r"found:  gcc -Dnq=1/0/ -O2[\s\S]*error"):
        sf.export(PENDULUM, "fmu2", tmp_path)
    assert not any(tmp_path.iterdir())


def test_an_export_of_another_kind_or_model_is_not_removed(tmp_path: Path) -> None:
    write_folder(tmp_path / "out", "urdf", "arm", {"arm.urdf": "x"}, "test")
    check_same(tmp_path / "out", "urdf", "arm")
    check_same(tmp_path / "new", "c", "arm")
    for target, name in (("mjcf", "arm"), ("urdf", "leg")):
        with pytest.raises(sf.ExportError, match="holds another export, which would be removed"):
            check_same(tmp_path / "out", target, name)
