"""A report of the matrix measured in parts: what is stored comes back, and parts that disagree are refused in words."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from validation.engines import parts
from validation.engines.report import compose
from validation.reporting import markdown
from validation.reporting.provenance import Provenance
from validation.reporting.record import Data

NAMES = st.sampled_from(("a", "b b", "c:d"))
ROWS = st.dictionaries(
    st.tuples(NAMES, NAMES, NAMES), st.tuples(NAMES, st.floats(0, 1), st.floats(0, 1), st.sampled_from(("", "says so")))
)


@given(ROWS)
def test_nested_tables_keep_every_row(rows: dict[tuple[str, ...], tuple[Any, ...]]) -> None:
    names = [*parts.CELLS[0], *parts.CELLS[1]]
    stated = [dict(zip(names, (*key, *values), strict=True)) for key, values in rows.items()]
    stored = json.loads(json.dumps(parts.nested(stated, parts.CELLS)))
    assert sorted(map(repr, parts.unnested(stored, parts.CELLS))) == sorted(map(repr, stated))


def part(engine: str, *models: str, **changes: Any) -> dict[str, Any]:
    """A stored report of one engine; the digest of what a tree's cells answer is the tree's name."""
    models = models or ("ball",)
    cells = {engine: {"bias": {model: ["right", 1e-16, 1e-12] for model in models}}}
    proof = {"engine": engine, "model": models[0], "function": "bias", "file": f"{engine}.py", "text": "assert False\n"}
    return {
        "models": list(models),
        "engines": [{"name": engine, "version": "1", "functions": {"bias": "h"}}],
        "absent": {},
        "functions": {"bias": "h"},
        "cells": cells,
        "corrected": {},
        "identities": {engine: {"C v + g = h": {model: [0.0, True] for model in models}}},
        "asked": {engine: {model: [model] for model in models}},
        "proofs": [proof],
        "ours": [engine],
        **{"revision": "abc", "date": "now", "versions": {"numpy": "2"}},
        **changes,
    }


def asked(*pairs: str) -> dict[tuple[str, str], str]:
    """What is asked, of "engine tree" pairs."""
    return {(engine, model): model for engine, _, model in (pair.partition(" ") for pair in pairs)}


def models_of(report: Data, table: str = "cells") -> dict[str, list[str]]:
    """The trees that a report's table has of each engine."""
    found: dict[str, list[str]] = {}
    for row in parts.unnested(report[table], parts.TABLES[table]):
        found.setdefault(row["engine"], []).append(row["model"])
    return found


def test_cells_taken_over_answer_the_present_questions() -> None:
    stored = part("mine", "ball", "free", "helical")
    (kept,) = parts.taken_over([stored], asked("mine ball", "mine helical") | {("mine", "free"): "another"})
    for table in ("cells", "identities", "asked"):
        assert models_of(kept, table) == {"mine": ["ball", "helical"]}
    assert parts.places(kept) == [("mine", "ball"), ("mine", "helical")]
    assert kept["proofs"] == stored["proofs"] and kept["ours"] == ["mine"]
    (left,) = parts.taken_over([stored], asked("mine free", "yours ball"))
    assert models_of(left) == {"mine": ["free"]} and left["proofs"] == []


def test_cells_are_taken_from_the_first_part_and_none_from_parts_without_digests() -> None:
    one, two = part("mine", "ball"), part("mine", "ball", "free")
    kept = parts.taken_over([one, two], asked("mine ball", "mine free"))
    assert [parts.places(each) for each in kept] == [[("mine", "ball")], [("mine", "free")]]
    older = {name: value for name, value in two.items() if name != "asked"}
    (none,) = parts.taken_over([older], asked("mine ball", "mine free"))
    assert none["cells"] == {} and none["engines"] == [] and none["proofs"] == []


def test_a_report_has_what_is_taken_over_with_its_origin() -> None:
    own = part("mine", "free", models=["ball", "free"], absent={"theirs": "pip install theirs", "no": "none"})
    stored = [
        part("theirs", "ball", "free"),
        part("mine", "ball", revision="def", functions={"bias": "h", "gone": "x"}),
    ]
    whole = parts.merged(own, stored)
    assert parts.engines_of([whole]) == {"mine": "1", "theirs": "1"} and whole["absent"] == {"no": "none"}
    assert models_of(whole) == {"mine": ["ball", "free"], "theirs": ["ball", "free"]}
    assert [one["revision"] for one in whole["origins"]] == ["abc", "def"]
    assert whole["asked"] == {
        "mine": {"ball": ["ball", 1], "free": ["free"]},
        "theirs": {"ball": ["ball", 0], "free": ["free", 0]},
    }
    assert set(whole["functions"]) == {"bias"} and whole["ours"] == ["mine", "theirs"]
    later = json.loads(json.dumps(dict(whole) | {"revision": "later"}))
    again = parts.merged(part("mine", "helical", models=["ball", "free", "helical"]), [later])
    rows = parts.unnested(again["asked"], parts.ASKED)
    origins = {
        (row["engine"], row["model"]): again["origins"][row["origin"]]["revision"]
        for row in rows
        if row["origin"] != ""
    }
    assert origins == {
        ("mine", "ball"): "def",
        ("mine", "free"): "later",
        ("theirs", "ball"): "abc",
        ("theirs", "free"): "abc",
    }
    assert "origins" not in parts.merged(part("mine"), [])


def test_a_report_says_which_cells_are_of_which_commit() -> None:
    def shown(data: Data) -> str:
        return markdown.page(compose(data), Provenance.of(data), "")

    functions = {"version": "1", "functions": {"bias": "h"}, "conventions": []}
    own = part("mine", "free", models=["ball", "free"], engines=[{"name": "mine", **functions}], proofs=[])
    stored = part("mine", "ball", revision="defdefdefdef", date="then", proofs=[])
    whole = {**parts.merged(own, [stored]), "revision": "fedfedfedfed"}
    assert "1 pair of an engine and a tree, of 2. then, defdefde." in shown(whole)
    assert "now, fedfedfe: 1; then, defdefde: 1" in shown(whole)
    assert (
        "Taken over" not in (all_asked := shown({**own, "revision": "fedfedfedfed"})) and "Not asked" not in all_asked
    )
    assert "Not asked anew: 3 pairs of an engine and a tree (a 2, b 1)" in shown({**own, "left": {"a": 2, "b": 1}})


def test_files_that_are_no_report_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "stored.json"
    for text in (json.dumps({"cells": []}), "{", ""):
        path.write_text(text)
        with pytest.raises(parts.NoPart, match="no stored engines.json"):
            parts.load([path])
    path.write_text(json.dumps(part("mine")))
    assert parts.load([path]) == [part("mine")]


def test_a_folder_has_the_scripts_of_proofs_alone(tmp_path: Path) -> None:
    (tmp_path / "gone.py").write_text("assert False\n")
    (tmp_path / "notes.txt").write_text("mine")
    without = {"file": "silent.py", "text": ""}
    parts.write_scripts([*part("theirs")["proofs"], without], tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {"theirs.py", "notes.txt"}
