"""Libraries that are known are found without generating their C text, and never for another request."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest

import symofros as sf
from reference_models.rigid.random_tree import random_tree
from symofros.errors import StoredStateWarning
from symofros.generator import units
from symofros.runtime.build import build


def compiled(system: sf.System, options: sf.Options | None = None) -> sf.Model:
    """A model with one function that is made: the options', or `dynamics`."""
    model = sf.compile(system, options)
    if options is None or options.functions is None:
        model.prepare("dynamics")
    return model


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path))
    return tmp_path


@pytest.fixture
def written(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The C texts that were generated."""
    texts: list[str] = []

    def model_source(*arguments: object, **named: object) -> str:
        texts.append(original(*arguments, **named))  # type: ignore[arg-type]
        return texts[-1]

    original = units.model_source
    monkeypatch.setattr(units, "model_source", model_source)
    return texts


def test_a_known_model_is_not_generated_again(cache: Path, written: list[str]) -> None:
    first = sf.compile(random_tree(31)).mass_matrix(sf.compile(random_tree(31)).neutral())
    count = len(written)
    again = sf.compile(random_tree(31))
    assert np.array_equal(again.mass_matrix(again.neutral()), first)
    assert len(written) == count == 1


@pytest.mark.parametrize(
    "options",
    [
        sf.Options(functions=("bias",)),
        sf.Options(flags=("-O1",)),
        sf.Options(batch="loop"),
        sf.Options(constraints="null_space"),
        sf.Options(forward_dynamics="articulated"),
    ],
)
def test_another_request_gives_another_model(cache: Path, written: list[str], options: sf.Options) -> None:
    compiled(random_tree(31))
    compiled(random_tree(31), options)
    assert len(written) == 2


def test_another_system_or_formula_gives_another_model(cache: Path, written: list[str]) -> None:
    m = compiled(random_tree(31))
    compiled(random_tree(32))
    assert len(written) == 2
    point = m.neutral()[None], np.zeros((1, m.nv)), np.zeros((1, m.nu)), np.zeros((1, 1))
    for formula, value in (("2", 2.0), ("3", 3.0), ("2", 2.0)):
        kernel = m.formulas([formula])
        assert kernel.run(1, kernel.prepare(m.parameter_values[None]), list(point))[0] == value
    assert len(written) == 4


def test_edited_generator_code_regenerates_the_text(
    cache: Path, written: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    compiled(random_tree(31))
    monkeypatch.setattr(build, "CODE_IDENTITY", "edited")
    compiled(random_tree(31))
    assert len(written) == 2


@pytest.mark.parametrize(
    "spoil",
    [lambda known, _: known.unlink(), lambda known, _: known.write_text("../other.so"), lambda _, made: made.unlink()],
)
def test_a_lost_library_is_rebuilt(cache: Path, written: list[str], spoil: object) -> None:
    compiled(random_tree(31))
    (known,), (library,) = cache.glob("*.known"), cache.glob("*.so")
    assert known.read_text() == library.name
    spoil(known, library)  # type: ignore[operator]
    compiled(random_tree(31))
    assert len(written) == 2 and known.read_text() == library.name and library.exists()


@pytest.mark.parametrize("damage", [b"", b"\0" * 40, b"\xff\xfe", b"../../../etc/passwd", b"{", None], ids=repr)
def test_a_damaged_cache_file_is_rebuilt(cache: Path, damage: bytes | None) -> None:
    system = random_tree(31)
    expected = compiled(system).mass_matrix(q := sf.compile(system).neutral())
    for file in sorted(cache.iterdir()):
        if file.suffix not in (".known", ".digest", ".fastest"):
            continue
        if damage is None and file.suffix != ".known":  # Where a library is to be, a folder is refused in words.
            continue
        file.unlink()
        file.mkdir() if damage is None else file.write_bytes(damage)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            assert np.array_equal(compiled(system).mass_matrix(q), expected)
        assert any(issubclass(one.category, StoredStateWarning) for one in caught) == (file.suffix != ".digest")
