"""The stage of a USD file as plain data, read by a process with few rights (usd_worker.py)."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from symofros.description.reading import read_bytes, resolved
from symofros.description.usd import usd_worker
from symofros.description.workers import answer_of
from symofros.errors import DescriptionError, Problem

MAX_BYTES = 512 << 20  # Of the root layer, which may hold meshes.
# Wall time of the process [s]; its processor time is bounded by itself.
TIMEOUT = 180


def stage_of(path: str | os.PathLike[str]) -> dict[str, Any]:
    """What the stage of a file states, in its own units (`usd_worker.stage_data`).

    Args:
        path: Root layer: .usd, .usda, .usdc, .usdz.

    Raises:
        DescriptionError: usd-core is not installed, the file can't be read, or is made of files of other folders.
    """
    file = Path(path)
    read_bytes(file, MAX_BYTES)
    answer = _answer(str(resolved(file)))
    if "absent" in answer:
        raise DescriptionError(
            Problem.of_extra(
                f"'{path}' can't be read: usd-core is not installed",
                "no module 'pxr'",
                "OpenUSD reads the layers of a stage",
                "usd",
            )
        )
    if "stage" not in answer:
        raise DescriptionError(
            Problem(
                "OpenUSD can't read the file",
                f"{answer.get('fault', 'nothing'):.500}",
                "a stage whose layers are at hand",
                "mend it; `usdchecker FILE` (OpenUSD's own) says more",
                str(path),
            )
        )
    stage: dict[str, Any] = answer["stage"]
    _refuse_outside(file, stage["layers"])
    return stage


def _refuse_outside(file: Path, layers: list[str]) -> None:
    """Refuse a stage that draws on other places than its own folder: who sends a file does not choose what is read."""
    folder = resolved(file).parent
    for layer in layers:
        # What lies in a .usdz is named FILE[MEMBER].
        inside = resolved(Path(layer.partition("[")[0]))
        if not inside.is_relative_to(folder):
            raise DescriptionError(
                Problem(
                    "the stage is made of files of other folders",
                    f"'{layer}'",
                    f"all layers lie in the folder of the file, '{folder}', or below",
                    "flatten it: `usdcat --flatten FILE -o FLAT.usdc`, or move the layers there",
                    str(file),
                )
            )


def _answer(file: str) -> dict[str, Any]:
    bounds = f"more than {usd_worker.SECONDS} s of processor time or too much memory, or is damaged"
    return answer_of(usd_worker.__file__, {"file": file}, TIMEOUT, bounds)
