"""Reads symofros-truth: `python read.py FOLDER` prints each value of each model; nothing but Python is needed."""

import json
import sys
from collections.abc import Iterator
from pathlib import Path


def values(folder: str) -> Iterator[tuple[str, int, str, list[int], list[float]]]:
    """(model, state, function, shape, numbers) of all values."""
    files = sorted(Path(folder, "values").glob("*.json"))
    if not files:
        sys.exit(f"no file values/*.json in '{folder}'; FOLDER is the one that has manifest.json in it")
    for file in files:
        data = json.loads(file.read_text())
        for index, state in enumerate(data["states"]):
            for function, value in state["values"].items():
                yield data["model"], index, function, value["shape"], [float(text) for text in value["digits"]]


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python read.py FOLDER, the folder that has manifest.json in it")
    for model, state, function, shape, numbers in values(sys.argv[1]):
        print(model, state, function, "x".join(map(str, shape)) or "1", *(f"{x:.17g}" for x in numbers))
