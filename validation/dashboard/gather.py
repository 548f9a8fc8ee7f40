"""Reports as they lie in a folder -> entries of the index; one that is absent, broken or out of date says so."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from ..reporting.command import present
from ..reporting.evidence import standing_text
from ..reporting.provenance import Provenance
from ..reporting.record import Data, Report, Topic
from .catalogue import TOPICS


@dataclass(frozen=True)
class Entry:
    """One report in the index.

    Attributes:
        topic: Topic of the report.
        report: Report; None if it is not there or can't be read.
        data: JSON of the report, with the provenance of its numbers.
        remarks: Remarks for a reader who relies on it.
        page: Full page in the same folder; empty if there is none.
    """

    topic: Topic
    report: Report | None
    data: Data
    provenance: Provenance
    remarks: tuple[str, ...] = ()
    page: str = ""

    @property
    def verdict(self) -> str:
        """The verdict in a word."""
        return "absent" if self.report is None else self.report.verdict

    @property
    def standing(self) -> str:
        """What a reader must know of its age; "" where its sources are those of now, or where there is none."""
        return self.provenance.standing if self.report else ""

    @property
    def said(self) -> str:
        """The report's summary in a sentence, or the remarks where there is no report."""
        return self.report.summary if self.report else "; ".join(self.remarks)


def gather(
    folder: Path,
    installed: Mapping[str, str],
    digest: Callable[[Topic], str] = present,
    names: Iterable[str] = TOPICS,
) -> dict[str, Entry]:
    """Reports of a folder.

    Args:
        folder: The folder.
        installed: Versions of now, which those of the reports are compared with.
        digest: Digest of the sources of a report as they are.
        names: Names of the reports.
    """
    return {name: _entry(folder, TOPICS[name], installed, digest) for name in names}


def _entry(folder: Path, topic: Topic, installed: Mapping[str, str], digest: Callable[[Topic], str]) -> Entry:
    pages = (f"{topic.name}.{kind}" for kind in ("html", "md", "json"))
    page = next((page for page in pages if (folder / page).is_file()), "")
    report, data, origin = None, {}, Provenance()
    try:
        data = json.loads((folder / f"{topic.name}.json").read_text(encoding="utf-8"))
        origin = Provenance.of(data, digest(topic))
        report = topic.compose(data)
        remarks = doubts(origin, installed)
    except FileNotFoundError:
        remarks = ["is not made yet"]
    except (json.JSONDecodeError, OSError) as error:
        remarks = [f"can't be read: {error}"]
    # A layout of another version may differ in any way; the error is reported, and the index is written without it.
    except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError) as error:
        remarks = [f"has a layout that is not known here ({type(error).__name__}: {error})"]
    return Entry(topic, report, data, origin, tuple(remarks), page)


def doubts(origin: Provenance, installed: Mapping[str, str]) -> list[str]:
    """Reasons why a report may not describe the present code: standing, missing provenance, changed packages."""
    asked = "when it was made", "on which machine", "with which versions"
    stated = zip(asked, (origin.date, origin.machine, origin.versions), strict=True)
    said = [standing_text(origin.standing)] if origin.standing else []
    said += [f"does not say {what}" for what, value in stated if not value]
    changed = [
        f"{name} {version}, now {installed[name]}"
        for name, version in origin.versions.items()
        if installed.get(name, version) != version
    ]
    return said + ([f"was made with {', '.join(changed)}"] if changed else [])
