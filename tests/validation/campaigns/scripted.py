"""Batches that do as told, in a module that workers import quickly."""

from __future__ import annotations

import os
import signal
from dataclasses import dataclass

import pyarrow as pa


@dataclass(frozen=True)
class Scripted:
    """A batch that does as told."""

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
