"""Hostile inputs for the fuzz campaign: the package's own descriptions, mutated at random from a seed."""

from __future__ import annotations

import json
import random
import re
from collections.abc import Iterator
from pathlib import Path

from .. import references

KINDS = ("yaml", "urdf", "formula", "diagram")
CORPUS = Path(__file__).parent.parent / "corpus"

_FORMULAS = (
    b"L1/2 + 0.1*cos(q1)",
    b"-k*(q1 - 0.3)^2",
    b"atan2(u1, max(a, b))/pi",
    b"2^-x*exp(-(v/0.01)^2)",
    b"m*(L^2/12 + r^2/4)",
    b"1 - -x**2**y/(3*z)",
)
# Kind -> texts that are hostile in its files, after those that are hostile wherever they stand; [TEXT, TIMES] repeats.
_STATED = json.loads(Path(__file__).with_name("snippets.json").read_text(encoding="utf-8"))
_WORD = re.compile(rb"[A-Za-z_]\w*|-?\d+(?:\.\d+)?")


def corpus(kind: str) -> list[bytes]:
    """Inputs from which mutations of a kind start: formulas, or files with that suffix."""
    if kind == "formula":
        return list(_FORMULAS)
    folders = (CORPUS, references.FOLDER)
    return [path.read_bytes() for folder in folders for path in sorted(folder.rglob(f"*.{kind}"))]


def mutated(kind: str, seed: int) -> Iterator[bytes]:
    """Endless mutations of the corpus of a kind, the same ones for the same seed."""
    rng, files = random.Random(f"{kind} {seed}"), corpus(kind)
    stated = (*_STATED["everywhere"], *_STATED.get(kind, ()))
    snippets = [(text if isinstance(text, str) else text[0] * text[1]).encode() for text in stated]
    while True:
        data = rng.choice(files)
        # Half of the inputs have a single fault: those come furthest.
        for _ in range(rng.choice((1, 1, 1, 2, 3, 4))):
            data = _mutate(data, snippets, rng)
        yield data


def _mutate(data: bytes, snippets: list[bytes], rng: random.Random) -> bytes:
    """One change: of a byte, of a piece, of a word, of the lines' order, or a hostile snippet put in."""
    at, kind = rng.randrange(len(data) + 1), rng.randrange(8)
    if kind == 0:
        return data[:at] + bytes([rng.randrange(256)]) + data[at + 1 :]
    if kind == 1:
        return data[:at] + data[at + rng.randint(1, 40) :]
    if kind == 2:
        return data[:at] + rng.choice(snippets) + data[at:]
    if kind == 3:
        return data[:at] + data[at : at + rng.randint(1, 60)] * rng.randint(1, 4) + data[at:]
    if kind == 4:
        lines = data.split(b"\n")
        first, second = rng.randrange(len(lines)), rng.randrange(len(lines))
        lines[first], lines[second] = lines[second], lines[first]
        return b"\n".join(lines)
    words = list(_WORD.finditer(data))
    if not words:
        return data
    # A word or number becomes another one of the file, or something hostile: the form stays whole.
    word = rng.choice(words)
    other = rng.choice(words).group() if kind < 7 else rng.choice(snippets)
    return data[: word.start()] + other + data[word.end() :]
