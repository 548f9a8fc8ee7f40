"""What a cell is an answer to: a digest of the question, the engine's release, and the code that asks and judges.

Code is read as Python has it in memory, from a few functions on: what they name of this harness, and what that names,
down to constants. Comments, names of files, functions that are not reached and other packages are no part of it.
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

from ..reporting.evidence import sources
from . import identities, lines, matrix, tree, workers
from .causes.cause import stated as causes
from .causes.corrections import CORRECTIONS
from .functions import FUNCTIONS, Function
from .interface import GROUP, EnginePlugin
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
    truths = (_truth(name.partition(":")[0]) for name in job.functions)
    question = job.form, job.text, job.seed, job.further, _tree(job.tree)
    return digest(
        plugin.name, version or plugin.version(), _plugin(plugin), _judging(), *question, *job.functions, *truths
    )


@cache
def _tree(one: tree.Tree) -> str:
    """A tree in text, and what follows from it."""
    before = stated(one.before) if one.changed else ""
    return digest(stated(one), before, *sorted(one.demands))


@cache
def _judging() -> str:
    return reached(*_JUDGING)


@cache
def _truth(name: str) -> str:
    return reached(FUNCTIONS[name].truth)


_PLUGINS: dict[int, tuple[EnginePlugin, str]] = {}


def _plugin(plugin: EnginePlugin) -> str:
    """A plug-in, with the corrections of its causes; that of our own engine has no release but its sources."""
    if id(plugin) not in _PLUGINS:
        corrected = [stated(one) for one in causes() if one.engine == plugin.name and one.correction]
        own = _our_sources() if plugin.package == "symofros" else ""
        packages = {one.module.partition(".")[0] for one in entry_points(group=GROUP) if one.name == plugin.name}
        # The plug-in is kept: no other object has its place in memory then.
        _PLUGINS[id(plugin)] = plugin, digest(reached(plugin, CORRECTIONS, packages=packages), own, *corrected)
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
    return repr(value)


def _empty(value: Any, one: Field[Any]) -> bool:
    """Whether a field is empty, and so by default: 0 is not None."""
    part = getattr(value, one.name)
    return type(part) is type(one.default) and not part and part == one.default


def reached(*roots: Any, packages: Iterable[str] = ()) -> str:
    """Digest of objects with all that they reach within this harness, and within further packages."""
    walk = _Walk(frozenset({_HARNESS, *packages}))
    return digest(*(text for one in roots for text in walk.texts(one)))


def _within(module: str, package: str) -> bool:
    return module == package or module.startswith(f"{package}.")


class _Walk:
    """A walk through objects, each once; the list of plug-ins, where it begins from what asks them, is not gone into.

    Args:
        packages: Packages whose code is followed.
    """

    def __init__(self, packages: frozenset[str]) -> None:
        self._packages = packages
        self._seen: dict[int, tuple[int, Any]] = {id(workers.registry): (0, workers.registry)}

    def texts(self, root: Any) -> Iterator[str]:
        """What objects consist of, in the order in which they are reached."""
        left = [root]
        while left:
            one = left.pop()
            if isinstance(one, str | bytes | int | float | complex | Decimal | None | type(Ellipsis)):
                yield repr(one)
                continue
            if id(one) in self._seen:
                yield f"#{self._seen[id(one)][0]}"
                continue
            self._seen[id(one)] = len(self._seen), one
            text, parts = self._parts(one)
            yield text
            left += reversed(parts)

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
        text = [one.__qualname__, *(f"{code.co_code.hex()} {code.co_names} {code.co_varnames}" for code in codes)]
        constants = [const for code in codes for const in _constants(code, one.__doc__)]
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
        if not self._is_own(one) or one.__module__ in _STATED[:1]:
            return _named(one), []
        parts = [
            value
            for name, value in vars(one).items()
            if not name.startswith("_abc") and (not name.startswith("__") or _is_written(value))
        ]
        known = vars(sys.modules[one.__module__])
        return _named(one), [*one.__bases__, *parts, *(known[name] for name in _annotated(one) if name in known)]

    def _is_own(self, one: Any) -> bool:
        return any(_within(getattr(one, "__module__", None) or "", package) for package in self._packages)


def _are_functions(mapping: Mapping[Any, Any]) -> bool:
    return all(isinstance(value, Function) for value in mapping.values())


def _annotated(one: Any) -> list[str]:
    """Names in the annotations of a function or class: what is passed to it is of these."""
    return [name for text in one.__annotations__.values() for name in _NAMES.findall(str(text))]


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
