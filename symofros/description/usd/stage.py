"""The stage of a USD file as plain data, read by a process with few rights (usd_worker.py)."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from symofros.description.reading import read_bytes, resolved
from symofros.description.usd import usd_worker
from symofros.description.workers import answer_of
from symofros.errors import DescriptionError, Problem

MAX_BYTES = 512 << 20  # Of the root layer, which may hold meshes.
# Wall time of the process [s]; its processor time is bounded by itself.
TIMEOUT = 180
_SOURCE = re.compile(r"^(Warning|Error|Runtime Error|Coding Error): in .*? (at line \d+ (of|in file) \S+ )?(--|:) ")
# How each error that OpenUSD raises begins.
_RAISED = re.compile(r"Error in '[^']*' at line \d+ in file \S+ : ")


def stage_of(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Contents of the stage of a file in its own units (`usd_worker.stage_data`), with OpenUSD's "warnings".

    Args:
        path: Root layer: .usd, .usda, .usdc, .usdz.

    Raises:
        DescriptionError: usd-core is not installed, the file can't be read, a part of it is missing, or it is made of
            files of other folders.
    """
    file = Path(path)
    read_bytes(file, MAX_BYTES)
    answer = _answer(str(resolved(file)))
    if "absent" in answer:
        raise DescriptionError.of_extra(
            f"'{path}' can't be read: usd-core is not installed",
            "no module 'pxr'",
            "OpenUSD reads the layers of a stage",
            "usd",
        )
    _refuse_outside(file, answer.get("layers", ()))
    if missing := tuple(_missing(text, path) for text in answer.get("missing", ())):
        raise DescriptionError(missing)
    if "stage" not in answer:
        warnings = "".join(f"; {text:.300}" for text in warnings_of(answer["printed"])[-1:])
        raise DescriptionError(
            "OpenUSD can't read the file",
            f"{_first_fault(answer.get('fault', 'nothing')):.500}{warnings}",
            "a stage whose layers are at hand",
            "mend it; `usdchecker FILE` (OpenUSD's own) says more",
            str(path),
        )
    stage: dict[str, Any] = answer["stage"]
    return {**stage, "warnings": warnings_of(answer["printed"])}


def warnings_of(printed: str) -> list[str]:
    """Distinct messages printed by OpenUSD, one per line, without their place in OpenUSD's source.

    Args:
        printed: Lines such as "Warning: in NAME at line N of FILE -- TEXT".
    """
    lines = (_SOURCE.sub("", line.strip()) for line in printed.splitlines())
    # It frames what it says of its environment, which is ours, in such signs.
    return list(dict.fromkeys(line for line in lines if line and not line.startswith("#")))


def _first_fault(fault: str) -> str:
    """The first of the errors that OpenUSD raised, without its place in OpenUSD's source: what is wrong in the file."""
    texts = (text.replace(r"\u0009", " ").strip(" '\n") for text in _RAISED.split(fault))
    return next((text for text in texts if text), fault)


def _missing(text: str, path: str | os.PathLike[str]) -> Problem:
    """A reference, payload or sublayer that OpenUSD leaves out of the stage."""
    return Problem(
        "a part of the stage is missing",
        f"{text:.500}",
        "every reference, payload and sublayer is a file of USD in the folder of the file or below, and has the prim",
        "put the file there, mend the path, or remove the reference; `usdchecker FILE` (OpenUSD's own) says more",
        str(path),
    )


def _refuse_outside(file: Path, layers: Iterable[str]) -> None:
    """Refuse a stage that reads outside its own folder, as its author must not choose which files are read."""
    folder = resolved(file).parent
    for layer in layers:
        if not resolved(Path(layer)).is_relative_to(folder):
            raise DescriptionError(
                "the stage is made of files of other folders",
                f"'{layer}'",
                f"all layers lie in the folder of the file, '{folder}', or below",
                "flatten it: `usdcat --flatten FILE -o FLAT.usdc`, or move the layers there",
                str(file),
            )


def _answer(file: str) -> dict[str, Any]:
    bounds = f"more than {usd_worker.SECONDS} s of processor time or too much memory, or is damaged"
    return answer_of(usd_worker.__file__, {"file": file}, TIMEOUT, bounds)
