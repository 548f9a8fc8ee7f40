"""A report of the matrix measured in parts: what is stored comes back, and parts that disagree are refused in words."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from validation.engines import parts

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


def part(engine: str, **changes: Any) -> dict[str, Any]:
    cells = {engine: {"bias": {"ball": ["right", 1e-16, 1e-12]}}}
    proof = {"engine": engine, "file": f"{engine}.py", "text": "assert False\n"}
    stated = {"question": parts.question(), "models": ["ball"], "engines": [{"name": engine}], "absent": {}}
    stated |= {
        "functions": {"bias": "h"},
        "cells": cells,
        "corrected": {},
        "identities": {engine: {}},
        "proofs": [proof],
    }
    return stated | {"revision": "abc", "date": "now", "versions": {"numpy": "2"}} | changes


def stored(folder: Path, *stated: dict[str, Any]) -> list[Path]:
    paths = [folder / f"{i}.json" for i in range(len(stated))]
    for path, one in zip(paths, stated, strict=True):
        path.write_text(json.dumps(one))
    return paths


def test_parts_merge_into_one_report_with_their_origin(tmp_path: Path) -> None:
    own = part("mine", absent={"theirs": "pip install theirs"})
    whole = parts.merged(own, parts.load(stored(tmp_path, part("theirs"), part("third"))))
    assert [engine["name"] for engine in whole["engines"]] == ["mine", "theirs", "third"]
    origin = {"revision": "abc", "date": "now", "versions": {"numpy": "2"}}
    assert [engine.get("measured") for engine in whole["engines"]] == [None, origin, origin]
    assert set(whole["cells"]) == {"mine", "theirs", "third"} and len(whole["proofs"]) == 3
    assert whole["absent"] == {}
    again = parts.merged(part("fourth"), parts.load(stored(tmp_path, dict(whole) | {"revision": "later"})))
    assert [e["measured"]["revision"] for e in again["engines"][1:]] == ["later", "abc", "abc"]
    parts.write_scripts(whole["proofs"], tmp_path / "engines")
    assert {path.name for path in (tmp_path / "engines").iterdir()} == {"mine.py", "theirs.py", "third.py"}


@pytest.mark.parametrize(
    ("stated", "word"),
    [
        ((part("a"), part("a")), "engine 'a' is in .*0.json and in .*1.json"),
        ((part("a", question="other"),), "other trees or truths.*question other"),
        (({k: v for k, v in part("a").items() if k != "question"},), "no question: it is of an older version"),
        (({"cells": []},), "no stored engines.json"),
    ],
)
def test_parts_that_disagree_are_refused(tmp_path: Path, stated: tuple[dict[str, Any], ...], word: str) -> None:
    with pytest.raises(parts.PartsDisagree, match=word):
        parts.load(stored(tmp_path, *stated))


def test_parts_of_different_trees_are_refused(tmp_path: Path) -> None:
    with pytest.raises(parts.PartsDisagree, match="different trees"):
        parts.merged(part("a"), parts.load(stored(tmp_path, part("b", models=["free"]))))


def _stored(path: Path, **changed: object) -> Path:
    engines = [{"name": name, "version": "1"} for name in ("mine", "yours")]
    table = {name: {"bias": {"ball": ["right", 0.0, 0.0]}} for name in ("mine", "yours")}
    data: dict[str, object] = {"question": parts.question(), "engines": engines, "models": ["ball"], "ours": ["mine"]}
    data.update(dict.fromkeys(parts.TABLES, table), proofs=[{"engine": "mine"}], revision="old")
    path.write_text(json.dumps(data | changed))
    return path


def test_a_report_gives_what_it_has_of_engines_that_are_not_asked_anew(tmp_path: Path) -> None:
    path = _stored(tmp_path / "engines.json")
    kept = parts.others(path, ["mine"], {"mine": "2", "yours": "1"})
    assert parts.engines_of([kept]) == {"yours"} and not kept["proofs"] and not kept["ours"]
    assert [set(kept[table]) for table in parts.TABLES] == [{"yours"}] * 3 and kept["revision"] == "old"
    assert parts.engines_of([parts.others(path, ["yours"], {"mine": "1"})]) == {"mine"}


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({}, "has yours 1, here it is 2: ask it anew, too, by --engine yours"),
        ({"question": "x"}, "held to other trees"),
    ],
)
def test_a_report_of_other_versions_or_questions_is_not_taken_over(
    changed: dict[str, object], said: str, tmp_path: Path
) -> None:
    path = _stored(tmp_path / "engines.json", **changed)
    with pytest.raises(parts.PartsDisagree, match=said):
        parts.others(path, ["mine"], {"mine": "1", "yours": "2"})
