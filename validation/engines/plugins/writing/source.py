"""Plug-ins that state an engine's calls as Python text: what answers in the matrix is what a red cell's script runs."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from typing import Any, NamedTuple

import numpy as np

from ....contract.raised import TEXT, kind_of
from ...interface import CALLS, DOUBLE, Array, Convention, EngineModel, Slot, State, Statement, Steps, Tree, Unsupported

# Names that not every tree's source defines -> why it may not.
OPTIONAL = {
    "js": "not for links without a joint of their own",
    "ks": "not for links without a joint of their own",
    "bs": "not for links without a joint of their own",
    "points": "not for constraints of this kind",
    "loops": "not for constraints of this kind",
    "loops_generic": "not for constraints of this kind",
    "cm": "not for constraints of this kind",
    "axes": "not for trees without constraints",
    "sensed": "not for trees without sensors",
    "held_by": "not for trees without constraints",
    "ends": "not for links without a joint of their own",
    "am": "not for constraints of this kind",
}
_INPUTS = ("q", "v", "a", "tau", "v2", "q2")
# Statements that make the matrices of `truth.geometry.turns.AXES`' half turns.
HALF_TURNS = """from itertools import product
turned_about = [np.array(u, float) for u in product(range(-2, 3), repeat=3) if u > (0, 0, 0)]
half_turns = [2 * np.outer(u, u) / (u @ u) - np.eye(3) for u in turned_about]
"""
# Statements that make the matrices of `truth.geometry.poses.on_end`: their zeros and ones are exact.
ON_END = """(c, x), (d, z) = ((np.cos(angle), np.sin(angle)) for angle in (v[0], v[2]))
on_end = [
    np.array([[d, -z, 0], [z, d, 0], [0, 0, 1.0]])
    @ np.array([[0, 0, s], [0, 1.0, 0], [-s, 0, 0]])
    @ np.array([[1.0, 0, 0], [0, c, -x], [0, x, c]])
    for s in (1.0, -1.0)
]
"""


# What the text of a way raises where an engine says that it has found no solution.
NO_SOLUTION = "RuntimeError: no solution is found"


class Way(NamedTuple):
    """How an engine does a function.

    Attributes:
        native: Name that the engine gives it.
        code: Statements that leave the result in `value`; they may use what the source defines, and the parts of the
            state by their names (`interface.State`).
        slack: Error that the engine documents, as part of the largest entry, or the steps of its differences.
        built: Text of the source -> what it is in the model that this way has of its own; () for none.
    """

    native: str
    code: str
    slack: float | Steps = 0.0
    built: tuple[tuple[str, str], ...] = ()


def ways_of(text: str) -> dict[str, Way]:
    """Ways by name, each as `== name | native | code`, or with the code on the lines after `== name | native`.

    Args:
        text: The ways in their order. After a name may stand ` ~ ` and the slack, a number or a function and its steps;
            `== #` begins a comment.

    Raises:
        ValueError: A name stands twice, or without what the engine calls it.
    """
    made: dict[str, Way] = {}
    for one in re.split("^== ", text, flags=re.MULTILINE)[1:]:
        if not one.startswith("#"):
            head, *code = one.removesuffix("\n").split("\n")
            name, native, *first = head.split(" | ", 2)
            name, _, slack = name.partition(" ~ ")
            if name in made:
                raise ValueError(f"two ways of one name: {name}")
            function, *steps = slack.split() or ["0"]
            error = Steps(function, *map(float, steps)) if steps else float(function)
            made[name] = Way(native, "\n".join((*first, *code)), error)
    return made


@dataclass(frozen=True)
class Source:
    """Text that builds a tree's model.

    Attributes:
        lines: Statements, imports first.
        optional: Name -> statements that define it, which only functions need that use it. A function that uses a
            name of OPTIONAL that is not among them is not offered for this tree.
        slots: See `EngineModel`.
        nq: Length of the engine's q.
        nv: Length of the engine's v.
        lacks: Functions that the engine doesn't offer for this tree.
        closing: Statements after all of these, run anew for each call: nothing is left of what others wrote there.
        spelling: Text of functions' code -> what it is for this tree.
        of_links: Name of a list of one thing a link, in the tree's order, which functions of links go through.
    """

    lines: tuple[str, ...]
    slots: tuple[tuple[Slot, ...], ...]
    nq: int
    nv: int
    optional: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    lacks: tuple[str, ...] = ()
    closing: tuple[str, ...] = ()
    spelling: Mapping[str, str] = field(default_factory=dict)
    of_links: str = ""

    def spelled(self, code: str) -> str:
        """Code as it is for this tree."""
        for general, own in self.spelling.items():
            code = code.replace(general, own)
        return code

    def script(self, *calls: tuple[Way, State]) -> str:
        """The statements that build the tree as the last call needs it, and for each way and state run what it is."""
        lines = [*self.built(calls[-1][0])]
        for way, state in calls:
            code = self.spelled(way.code)
            used = [name for name in _INPUTS if name in identifiers(code)]
            lines += [*(f"{name} = np.array({getattr(state, name).tolist()!r})" for name in used), code]
        return "\n".join(lines)

    def built(self, way: Way) -> tuple[str, ...]:
        """The statements that build the tree as a way needs it."""
        return (*self.own(way, self.text(closed=False)), *self.own(way, self.closing))

    @staticmethod
    def own(way: Way, lines: tuple[str, ...]) -> tuple[str, ...]:
        """Statements as they are for a model that a way has of its own."""
        for general, own in way.built:
            lines = tuple(line.replace(general, own) for line in lines)
        return lines

    def text(self, closed: bool = True) -> tuple[str, ...]:
        """The statements that build the tree, with all that functions need; `closed`: with those after all of these."""
        optional = (line for lines in self.optional.values() for line in lines)
        return (*self.lines, *optional, *(self.closing if closed else ()))


class SourceModel:
    """A model that text has built.

    Args:
        source: The text.
        ways: Functions by name.
        given: Objects that the text does not make.
        refusals: See `SourcePlugin`.
    """

    def __init__(
        self,
        source: Source,
        ways: Mapping[str, Way],
        given: Mapping[str, Any] | None = None,
        refusals: tuple[str, ...] = (),
    ) -> None:
        self._source, self._ways, self._refusals = source, ways, refusals
        self.slots, self.nq, self.nv = source.slots, source.nq, source.nv
        # What the text defines: the engine's own objects.
        self.names: dict[str, Any] = dict(given or {})
        _run("\n".join(source.text()), self.names)  # Our own text, of numbers and the engine's names.
        # Models that ways have of their own: those that build the same share it, as others share the tree's.
        self._built: dict[tuple[tuple[str, str], ...], dict[str, Any]] = {(): self.names}

    def call(self, function: str, state: State) -> Array | Unsupported:
        """A function in the engine's conventions (`EngineModel`)."""
        values = self.each(function, (state,))
        return values if isinstance(values, Unsupported) else np.asarray(values[0])

    def each(self, function: str, states: Iterable[State], links: Sequence[int] | None = None) -> Array | Unsupported:
        """Values of a function at N states (N, ...), one state after the other.

        Args:
            function: Its name.
            states: The states.
            links: The links that a function of links is wanted of; all, if not given.
        """
        try:
            ask = self.kept(function, links)
            if isinstance(ask, Unsupported):
                return ask
            values = np.array([ask(state) for state in states])
        except Exception as error:
            return refusal(error, self._refusals)
        is_of_all = links is not None and values.ndim > 1 and values.shape[1] != len(links)
        return np.asarray(values[:, list(links or ())]) if is_of_all else values

    def kept(self, function: str, links: Sequence[int] | None = None) -> Callable[[State], Array] | Unsupported:
        """A function whose calls share what the text makes: the engine's data are those that the last call left.

        Args:
            function: Its name.
            links: The links that the list of `Source.of_links` is cut to, where the text has it; all, if not given.
        """
        if function not in self._ways or function in self._source.lacks:
            return Unsupported(f"no {function}", offered=False)
        text = self._source.spelled(self._ways[function].code)
        for name in (OPTIONAL.keys() & identifiers(text)) - set(self._source.optional):
            return Unsupported(OPTIONAL[name], offered=False)
        code, names = compile(text, TEXT, "exec"), dict(self._names_of(self._ways[function]))
        _run("\n".join(self._source.own(self._ways[function], self._source.closing)), names)
        if links is not None and self._source.of_links in names:
            names[self._source.of_links] = [names[self._source.of_links][k] for k in links]
        used = [name for name in _INPUTS if name in identifiers(text)]  # As in `Source.script`.

        def ask(state: State) -> Array:
            for name in used:
                names[name] = getattr(state, name).copy()
            exec(code, names)
            return np.array(names["value"], dtype=float)

        return ask

    def _names_of(self, way: Way) -> dict[str, Any]:
        """What the text defines for a way."""
        if way.built not in self._built:
            names = dict(self.names)
            _run("\n".join(self._source.own(way, self._source.text(closed=False))), names)
            self._built[way.built] = names
        return self._built[way.built]

    def script(self, function: str, state: State, before: Sequence[tuple[str, State]] = ()) -> str:
        """The text that a call runs, with the state that it needs (`EngineModel`), after other calls."""
        return self._source.script(*((self._ways[name], at) for name, at in (*before, (function, state))))


def _run(text: str, names: dict[str, Any]) -> None:
    exec(compile(text, TEXT, "exec"), names)


def refusal(error: Exception, patterns: Iterable[str]) -> Unsupported:
    """An engine's refusal in its own words; whatever else was raised goes on.

    Args:
        error: What was raised.
        patterns: See `SourcePlugin.refusals`.
    """
    said = f"{type(error).__name__}: {error}".strip()
    if kind_of(error) == "refuses" or any(re.search(pattern, said) for pattern in patterns):
        return Unsupported(said)
    raise error


def identifiers(code: str) -> set[str]:
    """The names in some code."""
    return set("".join(letter if letter.isalnum() or letter == "_" else " " for letter in code).split())


@cache
def _installed(package: str) -> str:
    """Version of a package; "" where it is not installed. Its record is read once: it takes some milliseconds."""
    try:
        return version(package)
    except PackageNotFoundError:
        return ""


@dataclass(frozen=True)
class SourcePlugin:
    """A plug-in made of text (`interface.EnginePlugin`).

    Attributes:
        write: Tree -> text that builds it.
        ways: Functions by name.
        write_reading: Tree, format, file's text -> text that has the engine read the file.
        find: Version of an engine that is no Python distribution.
        constraints: Kinds of constraints that it has of its own -> what it calls them.
        demands: What it knows of `Tree.demands`, and how it writes a format anew -> what it calls that.
        refusals: Patterns of exceptions ("Type: message") by which the engine refuses, where it is not seen by where
            they are raised.
        statements: See `interface.Statement`.
        roundoff: Unit roundoff of its numbers.
        calls: Random states that a function is asked at besides.
    """

    name: str
    package: str
    extra: str
    conventions: tuple[Convention, ...]
    kinds: Mapping[str, str]
    ways: Mapping[str, Way]
    write: Callable[[Tree], Source | Unsupported]
    gravity: tuple[float, ...] = ()
    formats: tuple[str, ...] = ()
    write_reading: Callable[[Tree, str, str], Source | Unsupported] | None = None
    find: Callable[[], str] | None = None
    constraints: Mapping[str, str] = field(default_factory=dict)
    demands: Mapping[str, str] = field(default_factory=dict)
    refusals: tuple[str, ...] = ()
    statements: tuple[Statement, ...] = ()
    roundoff: float = DOUBLE
    calls: int = CALLS

    @property
    def functions(self) -> Mapping[str, str]:
        """Names of functions -> what the engine calls them."""
        return {name: way.native for name, way in self.ways.items()}

    @property
    def slacks(self) -> Mapping[str, float | Steps]:
        """Functions that are approximate by their documentation."""
        return {name: way.slack for name, way in self.ways.items() if way.slack}

    def version(self) -> str:
        """Version of the engine; "" where it is not installed."""
        return self.find() if self.find is not None else _installed(self.package)

    def build(self, tree: Tree) -> EngineModel | Unsupported:
        """The tree by the engine's API."""
        for name in sorted(tree.demands - set(self.demands)):
            return Unsupported(f"no trees with {name}", offered=False)
        for one in tree.constraints:
            if one.kind not in self.constraints:
                return Unsupported(f"no constraint of kind {one.kind}", offered=False)
        return self._made(self.write(tree))

    def read(self, tree: Tree, form: str, text: str) -> EngineModel | Unsupported:
        """A file by the engine's own parser."""
        if self.write_reading is None or form not in self.formats:
            return Unsupported(f"reads no {form}", offered=False)
        return self._made(self.write_reading(tree, form, text))

    def written(self, tree: Tree, form: str = "", text: str = "") -> Source | Unsupported:
        """The text of a tree, or of a file's reading."""
        if not form:
            return self.write(tree)
        return self.write_reading(tree, form, text) if self.write_reading else Unsupported("", offered=False)

    def building(self, tree: Tree, form: str = "", text: str = "") -> str:
        """The text that would build a tree, or have a file read; "" for none.

        Args:
            tree: The tree.
            form: Format of the file; "" for none.
            text: The file.
        """
        made = self.written(tree, form, text)
        return "" if isinstance(made, Unsupported) else "\n".join(made.text())

    def _made(self, source: Source | Unsupported) -> EngineModel | Unsupported:
        if not self.version():
            return Unsupported(f"{self.name} is not installed: pip install '{self.extra}'", offered=False)
        if isinstance(source, Unsupported):
            return source
        try:
            return SourceModel(source, self.ways, refusals=self.refusals)
        except Exception as error:
            return refusal(error, self.refusals)


class Series(NamedTuple):
    """A link's joints with the fixed ones folded into placements.

    Attributes:
        steps: Placement (R, p) and moving joint, in order.
        end: Placement of the link's frame after the last.
    """

    steps: tuple[tuple[Array, Array, Any], ...]
    end: tuple[Array, Array]


def series(joints: tuple[Any, ...]) -> Series:
    """Fold fixed joints into the placements of the moving ones."""
    steps = []
    R, p = np.eye(3), np.zeros(3)
    for joint in joints:
        p, R = p + R @ np.array(joint.p), R @ np.array(joint.R)
        if joint.kind != "fixed":
            steps.append((R, p, joint))
            R, p = np.eye(3), np.zeros(3)
    return Series(tuple(steps), (R, p))
