"""NumPy's .npz archives from untrusted files: what they state of their sizes is judged before unpacking."""

from __future__ import annotations

import lzma
import math
import zipfile
import zlib
from collections.abc import Container
from pathlib import Path
from tokenize import TokenError
from typing import IO, Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[Any]

# What damaged archives, streams and headers make the standard library raise; NotImplementedError: a compression method
# or an encryption that zipfile does not know.
_DAMAGE = (
    EOFError,
    KeyError,
    MemoryError,
    NotImplementedError,
    OverflowError,
    RuntimeError,
    SyntaxError,
    TokenError,
    TypeError,
    lzma.LZMAError,
    zipfile.BadZipFile,
    zlib.error,
)


class TooLargeError(ValueError):
    """An archive has more numbers than are read."""


def read_npz(path: Path, most_numbers: int, wanted: Container[str] | None = None) -> dict[str, Array]:
    """The arrays of an archive, of numbers or texts.

    Args:
        path: Path of the file.
        most_numbers: The most elements that all arrays together may have.
        wanted: Names of the arrays to read; None for all.

    Raises:
        OSError: The file can't be read.
        TooLargeError: The arrays are larger than that.
        ValueError: It is no such archive, or damaged, or holds something else than numbers and texts.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            members = {item.filename.removesuffix(".npy"): item for item in archive.infolist()}
            arrays: dict[str, Array] = {}
            for name, item in members.items():
                if wanted is None or name in wanted:
                    with archive.open(item) as stream:
                        arrays[name] = _array(name, stream, item.file_size, most_numbers)
                    most_numbers -= arrays[name].size
            return arrays
    except _DAMAGE as error:
        raise ValueError(f"{type(error).__name__}: {error}") from error


def _array(name: str, stream: IO[bytes], file_size: int, most_numbers: int) -> Array:
    """One array, whose header and length fit together."""
    version = np.lib.format.read_magic(stream)
    if version != (1, 0):  # Later versions allow records of many fields, in headers of gigabytes.
        raise ValueError(f"array '{name}': its header is of version {version}, numbers have (1, 0)")
    shape, by_columns, dtype = np.lib.format.read_array_header_1_0(stream)
    if dtype.kind not in "biufcSU" or dtype.fields or not dtype.itemsize:
        raise ValueError(f"array '{name}' holds {dtype!s:.60}; numbers or texts are read, objects never (allow_pickle)")
    size = math.prod(shape)
    # A long text counts as so many numbers.
    if size * max(1, dtype.itemsize // 16) > most_numbers:
        raise TooLargeError(f"array '{name}' has {size} elements of {dtype}")
    length = size * dtype.itemsize
    if file_size != stream.tell() + length:
        raise ValueError(f"array '{name}' states the shape {shape}, which takes {length} bytes; there are others")
    content = stream.read(length + 1)  # To the end, where the checksum is compared.
    if len(content) != length:
        raise ValueError(f"array '{name}' ends after {len(content)} of {length} bytes")
    values = np.frombuffer(content, dtype=dtype)
    return values.reshape(shape[::-1]).T if by_columns else values.reshape(shape)
