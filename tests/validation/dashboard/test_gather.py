from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from validation.dashboard.gather import Entry, gather
from validation.reporting import evidence
from validation.reporting.record import Topic

DIGEST = "0123456789abcdef"
FUZZ: dict[str, Any] = {
    "ok": True,
    "inputs": 10,
    "peak_memory_mib": 50,
    "faults": [],
    "kinds": {
        "yaml": {
            "inputs": 10,
            "refused": 9,
            "read": 1,
            "compiled": 1,
            "faults": 0,
            "slowest": 0.5,
            "slowest_input": 3,
        }
    },
    "digest": DIGEST,
    "date": "2026-11-20 10:00 UTC",
    "versions": {"numpy": "2.0"},
    "flags": "-O2",
    "machine": {"processor": "Z80", "cores": "1", "system": "CP/M"},
}


def digest(_: Topic) -> str:
    return DIGEST


def entry(folder: Path, name: str = "fuzz") -> Entry:
    return gather(folder, {"numpy": "2.0"}, digest)[name]


def write(folder: Path, data: object, name: str = "fuzz") -> Path:
    (folder / f"{name}.json").write_text(data if isinstance(data, str) else json.dumps(data))
    return folder


def test_a_report_entry_has_verdict_and_page(tmp_path: Path) -> None:
    (tmp_path / "fuzz.md").write_text("")
    found = entry(write(tmp_path, FUZZ))
    assert found.verdict == "good" and not found.remarks and found.page == "fuzz.md"
    assert found.report is not None and found.said == "10 hostile inputs: 0 crashed or hung a reader."
    assert found.provenance.machine == "Z80, 1 cores, CP/M" and ("flags", "-O2") in found.provenance.rows
    assert found.topic.command == "python -m validation fuzz"


@pytest.mark.parametrize(
    ("text", "says"),
    [("{", "can't be read"), ("[]", "layout that is not known"), ('{"ok": true}', "layout that is not known")],
)
def test_a_broken_report_is_marked_and_spares_the_others(tmp_path: Path, text: str, says: str) -> None:
    write(tmp_path, FUZZ, "fuzz")
    found = entry(write(tmp_path, text, "mutation"), "mutation")
    assert found.verdict == "absent" and says in found.remarks[0]
    assert entry(tmp_path).verdict == "good"


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"versions": {"numpy": "1.0"}}, "was made with numpy 1.0, now 2.0"),
        ({"digest": "another"}, "is older than the code it judges"),
        ({"digest": ""}, "was made before reports stated which code they judge"),
        ({"digests": [DIGEST, "another"]}, "is older than the code it judges"),
        ({"digest": evidence.MIXED}, "was made while the code changed"),
        ({"date": ""}, "does not say when it was made"),
        ({"machine": {}}, "does not say on which machine"),
        ({"versions": {}}, "does not say with which versions"),
    ],
)
def test_doubts_about_a_report_are_listed(tmp_path: Path, change: dict[str, Any], says: str) -> None:
    assert entry(write(tmp_path, FUZZ | change)).remarks == (says,)
