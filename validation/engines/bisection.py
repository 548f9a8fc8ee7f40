"""Since which release a cell is red, and from which on it is not: by halves, over the releases of an index."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path

from ..faults.environment import NotAskedError, default_folder, published
from .interface import EnginePlugin
from .releases import Opened, Release, opened
from .verdicts import RED, Cell, Verdict

# Faults of numbers.
_NUMBERS: tuple[Verdict, ...] = ("wrong", "imprecise")
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
        cell: ENGINE/TREE/FUNCTION, or that with =VERDICT: what a release has to be to have the fault. Otherwise it is
            what the stated release is, a wrong number, an exception or a crash: another fault says nothing of this one.
        pair: The plug-in, and a release that has the fault; without a version, the newest.
        requires: Further requirements of the environments.
        folder: Folder of the environments; None: in the cache folder.
        ask: Asks a release about the tree.

    Raises:
        NotAskedError: The releases can't be listed, or the stated one has not the fault.
        ValueError: There is no such verdict.
    """
    plugin, stated = pair
    what, _, verdict = cell.partition("=")
    if verdict and verdict not in RED:
        raise ValueError(f"no red verdict '{verdict}'; there are {', '.join(RED)}")
    listed, place, function = published(stated.package), folder or default_folder(), what.rpartition("/")[2]

    @cache
    def found(version: str) -> Cell | str:
        with opened([(plugin, replace(stated, version=version, requires=tuple(requires)))], place) as reach:
            if reach.failures:
                return next(iter(reach.failures.values()))
            return {one.function: one for one in ask(reach)}.get(function, "no such function")

    first = found(listed[_place(listed, stated.version)])
    wanted = (verdict,) if verdict else () if isinstance(first, str) else same_fault(first.verdict)
    search = Search(listed, lambda version: has_fault(found(version), wanted))
    bad = red_place(search, stated.version, f"{what}: {plugin.package}")
    yield f"{what}: {' or '.join(wanted)} at {plugin.package} {listed[bad]}"
    yield from span_lines(search, search.span(bad), plugin.package)


def same_fault(verdict: Verdict) -> tuple[Verdict, ...]:
    """The verdicts by which a fault goes on: numbers may be wrong by more or less."""
    return _NUMBERS if verdict in _NUMBERS else tuple(one for one in RED if one == verdict)


def has_fault(found: Cell | str, wanted: Collection[str]) -> bool | str:
    """Whether a cell has one of the verdicts that are wanted; in words, why it says nothing of them.

    Args:
        found: The cell; in words, why there is none.
        wanted: Verdicts.
    """
    if isinstance(found, str) or found.verdict in wanted:
        return found if isinstance(found, str) else True
    return False if found.verdict in ("right", *_NUMBERS) else f"{found.verdict}: {found.words}"


def _place(listed: Sequence[str], version: str) -> int:
    """The place of the stated release, or the newest."""
    return listed.index(version) if version in listed else len(listed) - 1


def red_place(search: Search, version: str, what: str) -> int:
    """The place of a red release: the stated one, or the newest.

    Raises:
        NotAskedError: It is not red.
    """
    listed = search.releases
    bad = _place(listed, version)
    if search.at(bad) is not True:
        raise NotAskedError(
            f"{what} {listed[bad]}: {search.at(bad) or 'has not this fault'}; state a release that has it by --at"
        )
    return bad


def span_lines(search: Search, span: Span, package: str) -> Iterator[str]:
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
