"""Reports as they lie in a folder -> entries of the dashboard; one that is absent, broken or out of date says so."""

from __future__ import annotations

import datetime
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from validation.dashboard.card import Card
from validation.dashboard.catalogue import TOPICS, Topic

# Older reports are still true of what they name; they are marked, so that nobody takes them for news.
STALE_DAYS = 30


@dataclass(frozen=True)
class Origin:
    """Where a report's numbers come from; empty where it does not say."""

    date: str
    machine: str
    flags: str
    versions: dict[str, str]


@dataclass(frozen=True)
class Entry:
    """One report on the dashboard.

    Attributes:
        name: Of its files.
        topic: What it is about.
        card: What it says; None if it is not there or can't be read.
        origin: Where from.
        remarks: What a reader should know before relying on it.
        page: Its full page, in the same folder; empty if there is none.
    """

    name: str
    topic: Topic
    card: Card | None
    origin: Origin
    remarks: tuple[str, ...] = ()
    page: str = ""

    @property
    def command(self) -> str:
        """What writes it."""
        return " ".join(("python -m validation", *self.topic.command))

    @property
    def verdict(self) -> str:
        """In one word."""
        if self.card is None:
            return "absent"
        return {True: "good", False: "bad", None: "measured"}[self.card.ok]


def gather(folder: Path, installed: Mapping[str, str], today: datetime.date) -> list[Entry]:
    """Every report that is known of.

    Args:
        folder: Of the reports.
        installed: Versions of now, with which those of a report are compared.
        today: From which their age counts.
    """
    return [_entry(folder, name, topic, installed, today) for name, topic in TOPICS.items()]


def _entry(folder: Path, name: str, topic: Topic, installed: Mapping[str, str], today: datetime.date) -> Entry:
    nowhere = Origin("", "", "", {})
    pages = [f"{name}.{kind}" for kind in ("html", "md", "json") if (folder / f"{name}.{kind}").is_file()]
    page = pages[0] if pages else ""
    try:
        data = json.loads((folder / f"{name}.json").read_text(encoding="utf-8"))
    except FileNotFoundError:
        return Entry(name, topic, None, nowhere, ("is not made yet",), page)
    except (ValueError, OSError) as error:
        return Entry(name, topic, None, nowhere, (f"can't be read: {error}",), page)
    origin = origin_of(data)
    try:
        card = topic.read(data)
    # A layout of another version may differ in any way; what went wrong with it is told, and the page stands.
    except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError) as error:
        remark = f"has a layout that is not known here ({type(error).__name__}: {error})"
        return Entry(name, topic, None, origin, (remark,), page)
    return Entry(name, topic, card, origin, tuple(doubts(origin, installed, today)), page)


def origin_of(data: Any) -> Origin:
    """From wherever a report says it: at the top, with the machine, or among its facts."""
    levels = [data] if isinstance(data, dict) else []
    levels += [data[key] for level in levels for key in ("machine", "facts") if isinstance(level.get(key), dict)]

    def found(key: str, default: Any) -> Any:
        return next((level[key] for level in levels if level.get(key)), default)

    flags, versions = found("flags", ""), found("versions", {})
    if isinstance(flags, dict):
        flags = "; ".join(f"{name} {value}" for name, value in flags.items())
    machine = [str(value) for value in (found("processor", ""), found("cores", ""), found("system", "")) if value]
    if len(machine) > 1:
        machine[1] += " cores"
    flags = flags if isinstance(flags, str) else " ".join(map(str, flags))
    versions = {str(name): str(value) for name, value in versions.items()} if isinstance(versions, dict) else {}
    return Origin(str(found("date", "")), ", ".join(machine), flags, versions)


def doubts(origin: Origin, installed: Mapping[str, str], today: datetime.date) -> list[str]:
    """Why a report may be out of date, or can't say."""
    asked = {
        "when it was made": origin.date,
        "on which machine": origin.machine,
        "with which versions": origin.versions,
    }
    said = [f"does not say {what}" for what, value in asked.items() if not value]
    changed = [
        f"{name} {version}, now {installed[name]}"
        for name, version in origin.versions.items()
        if name in installed and installed[name] != version
    ]
    said += [f"stale: made with {', '.join(changed)}"] if changed else []
    try:
        days = (today - datetime.date.fromisoformat(origin.date[:10])).days
    except ValueError:
        return said
    return [*said, f"stale: {days} days old"] if days > STALE_DAYS else said
