"""Since which release a cell is red, and from which on it is not: by halves, over the releases of an index."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from ..faults.environment import NotAskedError, default_folder, published
from .interface import EnginePlugin
from .releases import Opened, Release, opened
from .verdicts import RED, Cell

# Releases in a row that are asked before it is taken that none there answers.
_FEW = 3
# What cells an opened release gives on one tree or file.
Ask = Callable[[Opened], Sequence[Cell]]


@dataclass(frozen=True)
class Span:
    """The releases between which something is red.

    Attributes:
        first: The first red one that is known.
        before: The one before it that is not; "" where none before it answers.
        last: The last red one that is known.
        good: The first after it that is not; "" where none after it answers.
    """

    first: str
    before: str
    last: str
    good: str


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

    def change(self, bad: int, step: int) -> tuple[int, int | None]:
        """The last release that is red from a red one on, and the first after it that is not, if one answers.

        Strides are doubled until a release is not red, then halved; what says nothing is passed over.

        Args:
            bad: Place of a release that is red.
            step: 1 for later releases, -1 for earlier ones.
        """
        last, good, stride = bad, self._answering(bad + step, step), 1
        while good is not None and self.at(good):
            last, stride = good, 2 * stride
            good = self._answering(last + step * stride, step)
        while good is None and stride > 1:  # The end, or nothing but silence: what is before that?
            stride //= 2
            place = self._answering(last + step * stride, step)
            if place is not None and self.at(place):
                last = place
            else:
                good = place
        return self._halved(last, good, step) if good is not None else (last, None)

    def span(self, bad: int) -> Span:
        """The red releases around one that is red, the place of which is given."""
        first, before = self.change(bad, -1)
        last, good = self.change(bad, 1)
        names = ("" if place is None else self.releases[place] for place in (first, before, last, good))
        return Span(*names)

    def _halved(self, last: int, good: int, step: int) -> tuple[int, int]:
        """The same, between a red release and one that is not."""
        left = list(range(last + step, good, step))
        while left:
            middle = left[len(left) // 2]
            answer = self.at(middle)
            if isinstance(answer, str):
                left.remove(middle)
            elif answer:
                last, left = middle, left[left.index(middle) + 1 :]
            else:
                good, left = middle, left[: left.index(middle)]
        return last, good

    def _answering(self, place: int, step: int) -> int | None:
        """The first release that answers, of a few from a place on."""
        few = range(place, place + step * _FEW, step)
        return next((k for k in few if 0 <= k < len(self.releases) and not isinstance(self.at(k), str)), None)


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
    bad = red_place(search, stated.version, f"{cell}: {plugin.package}")
    yield f"{cell}: red at {plugin.package} {listed[bad]}"
    yield from told(search, search.span(bad), plugin.package)


def red_place(search: Search, version: str, what: str) -> int:
    """The place of a red release: the stated one, or the newest.

    Raises:
        NotAskedError: It is not red.
    """
    listed = search.releases
    bad = listed.index(version) if version in listed else len(listed) - 1
    if search.at(bad) is not True:
        raise NotAskedError(f"{what} {listed[bad]}: {search.at(bad) or 'is right'}; state a red release by --at")
    return bad


def told(search: Search, span: Span, package: str) -> Iterator[str]:
    """Lines that say what was found, and which releases said nothing."""
    listed = search.releases
    yield f"first bad: {package} {span.first}" + ("" if span.before else ", or one before: none of those answers")
    yield "first good: " + (f"{package} {span.good}" if span.good else f"none that answers; {span.last} is still red")
    yield from _silent(search.said)
    yield f"{len(search.said)} of {len(listed)} releases were asked; one change before and one after is assumed."


def _silent(said: Mapping[str, bool | str]) -> Iterator[str]:
    """Releases that said nothing, and why."""
    for version, answer in said.items():
        if isinstance(answer, str):
            yield f"passed over: {version}: {' '.join(answer.splitlines()[:2])}"
