"""Since which release a cell is red, and from which on it is not: by halves, over the releases of an index."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from ..faults.environment import NotAskedError, default_folder, published
from .interface import EnginePlugin
from .releases import Opened, Release, opened
from .verdicts import RED, Cell

# What cells an opened release gives on one tree or file.
Ask = Callable[[Opened], Sequence[Cell]]


@dataclass
class Search:
    """Releases of an engine, and what is known of them.

    Attributes:
        releases: Releases, the oldest first.
        ask: What a release says: whether the cell is red, or in words why it says nothing.
        said: What they have said.
    """

    releases: Sequence[str]
    ask: Callable[[str], bool | str]
    said: dict[str, bool | str] = field(default_factory=dict)

    def at(self, k: int) -> bool | str:
        """What a release says; it is asked once."""
        version = self.releases[k]
        if version not in self.said:
            self.said[version] = self.ask(version)
        return self.said[version]

    def first(self, places: Sequence[int]) -> int | None:
        """The first of some places whose release says something."""
        return next((k for k in places if not isinstance(self.at(k), str)), None)

    def change(self, low: int, high: int) -> int:
        """The first release above `low` that says what `high` says, and `low` does not, if there is one change between.

        Releases that say nothing are passed over.
        """
        left, wanted = list(range(low + 1, high)), self.at(high)
        while left:
            middle = left[len(left) // 2]
            answer = self.at(middle)
            if isinstance(answer, str):
                left.remove(middle)
            elif answer is wanted:
                high, left = middle, [k for k in left if k < middle]
            else:
                left = [k for k in left if k > middle]
        return high


def history(
    cell: str, pair: tuple[EnginePlugin, Release], requires: Sequence[str], folder: Path | None, ask: Ask
) -> Iterator[str]:
    """Lines that say when a cell was red, as they are found.

    Args:
        cell: ENGINE/TREE/FUNCTION.
        pair: The plug-in, and a release that has the fault; without a version, the newest.
        requires: Further requirements of the environments.
        folder: Folder of the environments; None: in the cache folder.
        ask: Asks a release about the tree.

    Raises:
        NotAskedError: The releases can't be listed, or the stated one is not red.
    """
    plugin, stated = pair
    listed, place, function = published(stated.package), folder or default_folder(), cell.rpartition("/")[2]

    def asked(version: str) -> bool | str:
        with opened([(plugin, replace(stated, version=version, requires=tuple(requires)))], place) as reach:
            if reach.failures:
                return next(iter(reach.failures.values()))
            found = {one.function: one for one in ask(reach)}.get(function)
        if found is None or (found.verdict != "right" and found.verdict not in RED):
            return f"{found.verdict}: {found.words}" if found else "no such function"
        return found.verdict in RED

    search = Search(listed, asked)
    bad = listed.index(stated.version) if stated.version in listed else len(listed) - 1
    if search.at(bad) is not True:
        said = search.at(bad) or "is right"
        raise NotAskedError(
            f"{cell}: {plugin.package} {listed[bad]}: {said}; state a red release by --at NAME==VERSION"
        )
    yield f"{cell}: red at {plugin.package} {listed[bad]}"
    yield from _found(search, bad, plugin.package)
    yield from _silent(search.said)
    yield f"{len(search.said)} of {len(listed)} releases were asked; one change before and one after is assumed."


def _found(search: Search, bad: int, package: str) -> Iterator[str]:
    """The first bad release and the first good one after it."""
    listed = search.releases
    oldest = search.first(range(bad))
    if oldest is None or search.at(oldest) is True:
        yield f"first bad: {package} {listed[bad if oldest is None else oldest]}, the oldest that answers, or before"
    else:
        yield f"first bad: {package} {listed[search.change(oldest, bad)]}"
    latest = search.first(range(len(listed) - 1, bad, -1))
    if latest is None or search.at(latest) is True:
        yield f"first good: none yet; {package} {listed[bad if latest is None else latest]} is the newest that answers"
    else:
        yield f"first good: {package} {listed[search.change(bad, latest)]}"


def _silent(said: Mapping[str, bool | str]) -> Iterator[str]:
    """Releases that said nothing, and why."""
    for version, answer in said.items():
        if isinstance(answer, str):
            yield f"passed over: {version}: {answer.splitlines()[0]}"
