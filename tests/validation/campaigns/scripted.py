"""Batches that follow a script, in a module that workers import quickly; files that are damaged."""

from __future__ import annotations

import io
import os
import signal
from dataclasses import dataclass

import pyarrow as pa
import pyarrow.parquet as parquet


@dataclass(frozen=True)
class Scripted:
    """A batch that follows a script."""

    number: int
    deed: str = "work"
    size: int = 1
    title: str = "scripted"

    def run(self) -> pa.Table:
        if self.deed == "die":
            os.kill(os.getpid(), signal.SIGKILL)
        if self.deed == "raise":
            raise ZeroDivisionError("a fault\nof ours")
        return pa.table({"batch": [self.number]})


def with_a_damaged_page(content: bytes) -> bytes:
    """A Parquet file with one bit of its first column's values flipped; its footer stays as it is."""
    column = parquet.ParquetFile(io.BytesIO(content)).metadata.row_group(0).column(0)
    at = column.data_page_offset + column.total_compressed_size
    if column.dictionary_page_offset is not None:
        at += column.dictionary_page_offset - column.data_page_offset
    return content[: at - 1] + bytes([content[at - 1] ^ 1]) + content[at:]
