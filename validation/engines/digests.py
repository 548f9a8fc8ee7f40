"""What a cell is an answer to: a digest of the question, the engine's release, and the code that asks and judges.

Of a plug-in that states an engine's calls as text, what counts is that text: how it comes about does not.

Code is read as Python has it in memory, from a few functions on: what they name of this harness, and what that names,
down to constants; of a class, the methods whose names are met on the way. Comments, names of files and of local
variables, functions that are not reached and other packages are no part of it.
"""

from __future__ import annotations

import hashlib
import re
import sys
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import Field, fields, is_dataclass
from decimal import Decimal
from functools import cache, partial
from importlib.metadata import entry_points
from inspect import unwrap
from types import CodeType, FunctionType, MethodType, ModuleType
from typing import Any

import numpy as np

from ..contract.raised import attempted
from ..reporting.evidence import sources
from . import identities, lines, matrix, tree, workers
from .causes.cause import stated as causes
from .causes.corrections import CORRECTIONS
from .functions import FUNCTIONS, Function
from .interface import GROUP, EnginePlugin, Steps
from .plugins.writing.source import Source, SourceModel, SourcePlugin
from .truth.dynamics import Point, Truth
from .workers import Job

# What asks and judges, whatever the function.
_JUDGING = (matrix.judged, workers.answered, identities.held)
# Here the harness is one package, in a wheel a part of another.
_HARNESS = __package__.rpartition(".")[0]
# What is stated is in the question.
_STATED = (tree.__name__, lines.__name__)
_LENGTH = 12
_NAMES = re.compile(r"[A-Za-z_]\w*")


def digest(*texts: object) -> str:
    """Digest of texts."""
    return hashlib.sha256("\n".join(map(str, texts)).encode()).hexdigest()[:_LENGTH]


def asked(plugin: EnginePlugin, job: Job, version: str = "") -> str:
    """What the cells of a job are answers to.

    Args:
        plugin: The engine.
        job: The job; its tree suits the engine.
        version: The engine's release; "": that which is here.
    """
    slacks = (plugin.slacks.get(name) for name in job.functions)
    names = [*job.functions, *(slack.function for slack in slacks if isinstance(slack, Steps))]
    truths = (_truth(name.partition(":")[0]) for name in names)
    question = job.form, job.text, job.seed, job.further, _tree(job.tree)
    made = _text(plugin, job) if type(plugin) is SourcePlugin else ""
    return digest(
        plugin.name, version or plugin.version(), _plugin(plugin), made, _judging(), *question, *job.functions, *truths
    )


@cache
def _tree(one: tree.Tree) -> str:
    """A tree in text, and what follows from it."""
    before = stated(one.before) if one.changed else ""
    return digest(stated(one), before, *map(sorted, (one.demands, one.forces, one.transformations)))


@cache
def _judging() -> str:
    return reached(*_JUDGING)


@cache
def _truth(name: str) -> str:
    # What truths are given is of these classes, whether they say so or not.
    return reached(FUNCTIONS[name].truth, Truth, Point)


def _text(plugin: SourcePlugin, job: Job) -> str:
    """The text that makes the model of a job and calls its functions; why there is none."""
    lacking = (
        sorted(job.tree.demands - set(plugin.demands)),
        [one.kind in plugin.constraints for one in job.tree.constraints],
    )
    source = attempted(plugin.written, job.tree, job.form, job.text)
    ways = (stated(plugin.ways[name]) for name in job.functions if name in plugin.ways)
    return digest(*lacking, stated(source) if isinstance(source, Source) else source, *ways)


_PLUGINS: dict[int, tuple[EnginePlugin, str]] = {}
# What of a plug-in of text has no part in answers, or is in the digest of each.
_TEXTS = frozenset("write write_reading ways demands constraints kinds conventions extra formats find".split())


def _plugin(plugin: EnginePlugin) -> str:
    """A plug-in but for its texts, and corrections of its causes; that of our engine has no release but its sources."""
    if id(plugin) not in _PLUGINS:
        names = {one.correction for one in causes() if one.engine == plugin.name and one.correction}
        corrected = [stated(one) for one in causes() if one.engine == plugin.name and one.correction]
        own = _our_sources() if plugin.package == "symofros" else ""
        packages = {one.module.partition(".")[0] for one in entry_points(group=GROUP) if one.name == plugin.name}
        roots: list[Any] = [plugin]
        if type(plugin) is SourcePlugin:
            rest = {one.name: getattr(plugin, one.name) for one in fields(plugin) if one.name not in _TEXTS}
            roots = [SourcePlugin, SourceModel, rest]
        walked = reached(*roots, {name: CORRECTIONS[name] for name in sorted(names)}, packages=packages, whole=True)
        # The plug-in is kept: no other object has its place in memory then.
        _PLUGINS[id(plugin)] = plugin, digest(walked, own, *corrected)
    return _PLUGINS[id(plugin)][1]


def _our_sources() -> str:
    """The sources of the package that generates code."""
    texts = (f"{name} {path.read_text('utf-8')}" for name, path in sources("engines") if name.startswith("symofros/"))
    return digest(*texts)


def stated(value: Any) -> str:
    """Data in text; fields that are left empty, as they are by default, are left out: more of them change nothing."""
    if is_dataclass(value) and not isinstance(value, type):
        own = {one.name: getattr(value, one.name) for one in fields(value) if not _empty(value, one)}
        return f"{type(value).__name__}({', '.join(f'{name}={stated(part)}' for name, part in own.items())})"
    if isinstance(value, tuple):
        return f"{type(value).__name__}({', '.join(map(stated, value))})"
    if isinstance(value, Mapping):
        return f"{{{', '.join(f'{stated(key)}: {stated(part)}' for key, part in value.items())}}}"
    return repr(value)


def _empty(value: Any, one: Field[Any]) -> bool:
    """Whether a field is empty, and so by default: 0 is not None."""
    part = getattr(value, one.name)
    return type(part) is type(one.default) and not part and part == one.default


def reached(*roots: Any, packages: Iterable[str] = (), whole: bool = False) -> str:
    """Digest of objects with all that they reach within this harness, and within further packages.

    Args:
        roots: The objects.
        packages: Further packages.
        whole: Whether all methods of classes count: those who call them are not reached from these objects.
    """
    walk = _Walk(frozenset({_HARNESS, *packages}), whole)
    return digest(*(text for one in roots for text in walk.texts(one)))


def _within(module: str, package: str) -> bool:
    return module == package or module.startswith(f"{package}.")


class _Walk:
    """A walk through objects, each once; the list of plug-ins, where it begins from what asks them, is not gone into.

    Args:
        packages: Packages whose code is followed.
        whole: Whether all methods of classes are followed, whatever their names.
    """

    def __init__(self, packages: frozenset[str], whole: bool) -> None:
        self._packages, self._whole = packages, whole
        self._seen: dict[int, tuple[int, Any]] = {id(workers.registry): (0, workers.registry)}
        # Names that were met; methods of classes that were reached, by names that were not.
        self._met: set[str] = set()
        self._unmet: dict[str, list[Any]] = {}
        self._left: list[Any] = []

    def texts(self, root: Any) -> Iterator[str]:
        """What objects consist of, in the order in which they are reached."""
        self._left.append(root)
        while self._left:
            one = self._left.pop()
            if isinstance(one, str | bytes | int | float | complex | Decimal | None | type(Ellipsis)):
                self._meet([one] if isinstance(one, str) else [])
                yield repr(one)
                continue
            if id(one) in self._seen:
                yield f"#{self._seen[id(one)][0]}"
                continue
            self._seen[id(one)] = len(self._seen), one
            text, parts = self._parts(one)
            yield text
            self._left += reversed(parts)

    def _meet(self, names: Iterable[str]) -> None:
        """Go on with methods of these names; attributes may be read by names in texts, too."""
        for name in (part for whole in names for part in whole.strip("'").split(".")):
            if name not in self._met and name.isidentifier():
                self._met.add(name)
                self._left += self._unmet.pop(name, ())

    def _parts(self, one: Any) -> tuple[str, list[Any]]:
        """What an object is called, and its parts."""
        kind = type(one).__name__
        if isinstance(one, Function) or (isinstance(one, dict) and one and _are_functions(one)):
            return "functions", []  # Their truths count where they are asked for.
        if isinstance(one, tuple | list):
            return f"{kind} {len(one)}", list(one)
        if isinstance(one, set | frozenset):
            return f"{kind} {sorted(map(repr, one))}", []
        if isinstance(one, Mapping):
            return f"mapping {len(one)}", [part for pair in one.items() for part in pair]
        if isinstance(one, np.ndarray):
            return f"array {one.shape}", one.ravel().tolist()
        if isinstance(one, re.Pattern):
            return f"pattern {one.pattern} {one.flags}", []
        if isinstance(one, partial):
            return kind, [one.func, one.args, one.keywords]
        if isinstance(one, MethodType):
            return kind, [one.__func__, one.__self__]
        if isinstance(one, property):
            return kind, [one.fget]
        if isinstance(one, staticmethod | classmethod) or hasattr(one, "__wrapped__"):
            return kind, [one.__wrapped__, *_captured(one)]
        if isinstance(one, FunctionType):
            return self._function(one) if self._is_own(one) else (_named(one), _captured(one))
        if isinstance(one, type):
            return self._class(one)
        if isinstance(one, ModuleType) or not self._is_own(type(one)):
            return _named(one), []
        own = (
            [getattr(one, field.name, None) for field in fields(one)] if is_dataclass(one) else list(vars(one).values())
        )
        return kind, [type(one), *own]

    def _function(self, one: FunctionType) -> tuple[str, list[Any]]:
        """The code of a function, and what it names."""
        codes = list(_codes(one.__code__))
        names = [name for code in codes for name in code.co_names]
        text = [one.__qualname__, *(f"{code.co_code.hex()} {code.co_names} {_arguments(code)}" for code in codes)]
        constants = [const for code in codes for const in _constants(code, one.__doc__)]
        self._meet([*names, *_texts(constants)])
        parts = [one.__defaults__, one.__kwdefaults__, *_captured(one)]
        for name in dict.fromkeys([*names, *_annotated(one)]):
            if name in one.__globals__:
                parts += self._named_parts(one.__globals__[name], names)
        return "\n".join((*text, *map(repr, constants))), parts

    def _named_parts(self, value: Any, names: list[str]) -> list[Any]:
        """What a global name stands for; of a module, what is named of it."""
        if not isinstance(value, ModuleType):
            return [value]
        if not any(_within(value.__name__, package) for package in self._packages):
            return [_named(value)]
        return [
            part
            for name in dict.fromkeys(names)
            if name in vars(value)
            for part in self._named_parts(vars(value)[name], names)
        ]

    def _class(self, one: type) -> tuple[str, list[Any]]:
        """What the methods and constants of a class are; what is stated to engines is in the question."""
        if not self._is_own(one) or one is tree.Tree:
            return _named(one), []
        is_stated = one.__module__ in _STATED
        parts: list[Any] = [] if is_stated else [*one.__bases__]
        for name, value in vars(one).items():
            is_method = _is_method(value)
            if name.startswith("_abc") or (name.startswith("__") and not _is_written(value)):
                continue
            if is_method and not (self._whole or name.startswith("__") or name in self._met):
                self._unmet.setdefault(name, []).append(value)
            elif is_method or not is_stated:
                parts.append(value)
        known = vars(sys.modules[one.__module__])
        names = () if is_stated else (name for name in _annotated(one) if name in known)
        return one.__qualname__, [*parts, *(known[name] for name in names)]

    def _is_own(self, one: Any) -> bool:
        return any(_within(getattr(one, "__module__", None) or "", package) for package in self._packages)


def _are_functions(mapping: Mapping[Any, Any]) -> bool:
    return all(isinstance(value, Function) for value in mapping.values())


def _annotated(one: Any) -> list[str]:
    """Names in the annotations of a function or class: what is passed to it is of these."""
    return [name for text in one.__annotations__.values() for name in _NAMES.findall(str(text))]


def _arguments(code: CodeType) -> tuple[str, ...]:
    """The names of a function's arguments."""
    return code.co_varnames[: code.co_argcount + code.co_kwonlyargcount]


def _texts(constants: Iterable[Any]) -> Iterator[str]:
    """The texts in constants, and in tuples and sorted sets of them."""
    for one in constants:
        if isinstance(one, str):
            yield one
        elif isinstance(one, tuple | list):
            yield from _texts(one)


def _is_method(value: Any) -> bool:
    """Whether it is called or read by its name only."""
    return isinstance(value, FunctionType | property | staticmethod | classmethod) or hasattr(value, "__wrapped__")


def _is_written(value: Any) -> bool:
    """Whether a method is in a file; those that dataclasses make follow from their fields."""
    code = getattr(unwrap(value), "__code__", None) if callable(value) else None
    return code is not None and not code.co_filename.startswith("<")


def _named(one: Any) -> str:
    """An object of another package by its name."""
    own = one if hasattr(one, "__qualname__") or isinstance(one, ModuleType) else type(one)
    return f"{getattr(own, '__module__', '')} {getattr(own, '__qualname__', own.__name__)}"


def _captured(one: Any) -> list[Any]:
    """What a function holds of the one that made it."""
    cells = getattr(one, "__closure__", None) or ()
    return [cell.cell_contents for cell in cells]


def _codes(code: CodeType) -> Iterator[CodeType]:
    """A code with those within it."""
    yield code
    for const in code.co_consts:
        if isinstance(const, CodeType):
            yield from _codes(const)


def _constants(code: CodeType, text: str | None) -> Iterator[Any]:
    """The constants of a code, without what documents it."""
    for const in code.co_consts:
        if isinstance(const, frozenset):
            yield sorted(map(repr, const))
        elif not isinstance(const, CodeType) and (text is None or const != text):
            yield const
