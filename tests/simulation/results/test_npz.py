"""Archives of arrays are read whole or refused in words, whatever is done to their bytes."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symofros.simulation.results.npz import TooLargeError, read_npz

ARRAYS = {
    "t": np.linspace(0.0, 1.0, 5),
    "q": np.arange(12, dtype=np.float32).reshape(4, 3),
    "by_columns": np.asfortranarray(np.arange(6).reshape(2, 3)),
    "none": np.zeros((5, 0)),
    "scalar": np.array(2.5),
    "names": np.array(["q1", "q_two"]),
}


@pytest.mark.parametrize("save", [np.savez, np.savez_compressed])
def test_files_written_by_numpy_are_read(tmp_path: Path, save: Callable[..., None]) -> None:
    save(tmp_path / "a.npz", **ARRAYS)
    arrays = read_npz(tmp_path / "a.npz", 100)
    assert arrays.keys() == ARRAYS.keys()
    for name, values in ARRAYS.items():
        assert arrays[name].dtype == values.dtype
        np.testing.assert_array_equal(arrays[name], values, strict=True)
    assert read_npz(tmp_path / "a.npz", 5, ("t", "absent")).keys() == {"t"}


def member(header: str, content: bytes = b"", version: bytes = b"\x01\x00") -> bytes:
    text = header.encode()
    return b"\x93NUMPY" + version + len(text).to_bytes(2 if version[0] == 1 else 4, "little") + text + content


def stating(shape: str, dtype: str = "<f8") -> str:
    return f"{{'descr': '{dtype}', 'fortran_order': False, 'shape': {shape}}}"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (member(stating("(1000000000000,)"), b"12345678"), "has 1000000000000 elements"),
        (member(stating("(4,)"), b"12345678"), "takes 32 bytes"),
        (member(stating("(-1, -1)"), b"12345678"), "dimension"),
        (member(stating("(1,)", "|O"), b"12345678"), "allow_pickle"),
        (member(stating("(2,)", "|V0")), "holds"),
        (member(stating("(1,)", "<U2000000"), b""), "elements"),
        (member("{" * 200), "TokenError|header"),
        (member("\\"), "TokenError|header"),  # From Python 3.12 on the tokenizer refuses it first.
        (member(stating("(1,)"), b"12345678", version=b"\x02\x00"), "version"),
        (b"no array", "magic"),
        (b"", "."),
    ],
)
def test_headers_that_lie_are_refused(tmp_path: Path, content: bytes, message: str) -> None:
    with zipfile.ZipFile(tmp_path / "a.npz", "w") as archive:
        archive.writestr("t.npy", content)
    with pytest.raises(ValueError, match=message):
        read_npz(tmp_path / "a.npz", 1000)


def test_the_limit_is_on_all_arrays_together_and_judged_before_unpacking(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "a.npz", "w", zipfile.ZIP_DEFLATED) as archive:
        for name in "abc":
            archive.writestr(f"{name}.npy", member(stating("(400,)", "|i1"), bytes(400)))
    assert len(read_npz(tmp_path / "a.npz", 1200)) == 3
    with pytest.raises(TooLargeError):
        read_npz(tmp_path / "a.npz", 1199)


def archive_of(compression: int) -> bytes:
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", compression) as archive:
        for name, values in ARRAYS.items():
            part = io.BytesIO()
            np.save(part, values)
            archive.writestr(f"{name}.npy", part.getvalue())
    return content.getvalue()


ARCHIVES = [archive_of(way) for way in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA)]


@settings(max_examples=300)
@given(
    archive=st.sampled_from(ARCHIVES),
    at=st.floats(0.0, 1.0),
    put=st.binary(min_size=1, max_size=6),
    cut=st.booleans(),
)
def test_damaged_archives_are_read_or_refused(
    archive: bytes, at: float, put: bytes, cut: bool, tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = tmp_path_factory.getbasetemp() / "damaged.npz"
    start = int(at * len(archive))
    path.write_bytes(archive[:start] if cut else archive[:start] + put + archive[start + len(put) :])
    try:
        read_npz(path, 1000)
    except (ValueError, OSError) as error:
        assert str(error)


@pytest.mark.parametrize("kind", ["<M8[ns]", "<m8[s]", "V8"])
def test_arrays_are_of_numbers_and_texts(kind: str, tmp_path: Path) -> None:
    np.savez(tmp_path / "dates.npz", t=np.zeros(2, dtype=kind))
    with pytest.raises(ValueError, match="numbers or texts are read"):
        read_npz(tmp_path / "dates.npz", 1000)
