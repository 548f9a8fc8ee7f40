"""How a model is read, as commands state it: the arguments of `sf.load` as options, defined once for all commands.

What `symofros compile` does where the cache knows its answer imports this: nothing here reads models.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass, replace
from functools import wraps
from pathlib import Path
from typing import Annotated, Any, TypeVar

import typer

from symofros.base.names import QUOTED_NAME, name_of
from symofros.errors import Problem, SymofrosError

_Command = TypeVar("_Command", bound=Callable[..., Any])
# Parameter of a command that takes all options below.
PARAMETER = "reading"
# Stated here, as what reads them is not loaded for a cached answer: formats whose files name no packages, and our own.
_OF_ONE_PLACE = (".yaml", ".yml", ".usd", ".usda", ".usdc", ".usdz")
_NATIVE = (".yaml", ".yml")
_QUOTED = re.compile(QUOTED_NAME, re.ASCII)


@dataclass(frozen=True)
class ReadingOptions:
    """Options of `sf.load`; hashable, as `sf.load` has them where they are mappings or lists.

    Attributes:
        floating_base: Whether the body that stands on the ground goes onto a free joint.
        mimic: Whether joints of a URDF that mimic others are coupled to them.
        waive: Checks that every body may fail.
        packages: Names and folders of packages.
        arguments: Names and values of xacro's arguments.
        dissipation: What is kept of passive losses; "" for what the format keeps by default.
        limits: What limits of coordinates are; "" for data.
        prefix: Beginning of the names of the options that state all this.
    """

    floating_base: bool = False
    mimic: bool = False
    waive: tuple[str, ...] = ()
    packages: tuple[tuple[str, str], ...] = ()
    arguments: tuple[tuple[str, str], ...] = ()
    dissipation: str = ""
    limits: str = ""
    prefix: str = "--"

    @property
    def keywords(self) -> dict[str, Any]:
        """What is stated, as keywords of `sf.load`."""
        stated = {name: value for name in _OPTIONS if (value := getattr(self, name))}
        mappings = {name: dict(stated[name]) for name in ("packages", "arguments") if name in stated}
        return stated | mappings

    def fit_for(self, path: Path) -> ReadingOptions:
        """The same for one of several files of different formats: without what its format has not."""
        suffix = path.suffix.lower()
        own = self if suffix == ".xacro" else replace(self, arguments=())
        if suffix in _OF_ONE_PLACE:
            own = replace(own, packages=())
        if suffix in _NATIVE:
            own = replace(own, floating_base=False, dissipation="", limits="")
        return own if suffix in (".urdf", ".xacro") else replace(own, mimic=False)

    @property
    def changes_forces(self) -> bool:
        """Whether an engine that reads the file by itself has other passive forces."""
        return bool(self.dissipation or self.limits)

    def without(self, names: Collection[str]) -> ReadingOptions:
        """The same without options of some names."""
        default = ReadingOptions()
        return replace(self, **{name: getattr(default, name) for name in names})

    def check_waivers(self) -> None:
        """Refuse checks that do not exist.

        Raises:
            DescriptionError: There is one.
        """
        from symofros.loading import check_waivers  # What is answered from the cache loads no reader.

        check_waivers(self.waive)

    def require_none(self, why: str) -> None:
        """Refuse options where no model is read by them.

        Raises:
            SymofrosError: Some are stated.
        """
        if stated := ", ".join(self.keywords):
            rule = "options of reading apply to the file of a model"
            raise SymofrosError(Problem(f"options of reading: {why}", stated, rule, "leave them out"))


# As a command states them.
_OPTIONS: dict[str, tuple[Any, Any]] = {
    "floating_base": (
        bool,
        typer.Option("--floating-base", help="Put the body that stands on the ground onto a free joint."),
    ),
    "mimic": (bool, typer.Option("--mimic", help="Couple the joints of a URDF that mimic others to them.")),
    "waive": (
        list[str],
        typer.Option(
            "--waive", metavar="CHECK", help="A check that every body may fail, such as massless_tip; repeatable."
        ),
    ),
    "packages": (
        list[str],
        typer.Option(
            "--package",
            metavar="NAME=FOLDER",
            help="A further folder that the model's files may be read from, by the name they give it; repeatable.",
        ),
    ),
    "arguments": (
        list[str],
        typer.Option("--argument", metavar="NAME=VALUE", help="An argument of a xacro file; repeatable."),
    ),
    "dissipation": (
        str,
        typer.Option(
            "--dissipation",
            metavar="WHAT",
            help="What to keep of a file's passive losses: none (as of URDF by default), viscous (dampers, as of MJCF, "
            "SDF and USD), or all (dry friction, too).",
            show_default=False,
        ),
    ),
    "limits": (
        str,
        typer.Option(
            "--limits",
            metavar="HOW",
            help="What limits of coordinates are: data (the default), or stops that push back.",
            show_default=False,
        ),
    ),
}


def reading_of(
    *,
    floating_base: bool = False,
    mimic: bool = False,
    waive: Iterable[str] = (),
    packages: Iterable[str] = (),
    arguments: Iterable[str] = (),
    dissipation: str = "",
    limits: str = "",
    prefix: str = "--",
) -> ReadingOptions:
    """Options as they are stated, NAME=TEXT where they are pairs.

    Args:
        floating_base: As in `ReadingOptions`, like the next two.
        mimic: As there.
        waive: As there.
        packages: Pairs of names and folders.
        arguments: Pairs of names and values.
        dissipation: As in `ReadingOptions`, like the next one.
        limits: As there.
        prefix: Beginning of the options' names, for the problem.

    Raises:
        SymofrosError: A text is no pair.
    """
    named = _named(pairs(packages, f"{prefix}package", "hand_description=../hand_description"))
    given = _named(pairs(arguments, f"{prefix}argument", "gripper=true", empty=True))
    mappings = tuple(named.items()), tuple(given.items())
    return ReadingOptions(floating_base, mimic, tuple(waive), *mappings, dissipation, limits, prefix)


def _named(stated: dict[str, str]) -> dict[str, str]:
    """Pairs by what they name, without backquotes; those of formulas keep theirs."""
    return {name_of(name): text for name, text in stated.items()}


def pairs(given: Iterable[str], what: str, example: str, *, empty: bool = False) -> dict[str, str]:
    """NAME=TEXT options as a mapping; a name that holds an equals sign stands between backquotes, which it keeps.

    Args:
        given: The texts.
        what: Name of the option, for the problem.
        example: A pair, for the remedy.
        empty: Whether a text may be empty, as that of an argument of xacro.

    Raises:
        SymofrosError: A text is no pair.
    """
    stated = {}
    for item in given:
        begin = _QUOTED.match(item)
        head = begin.group() if begin else ""
        rest, sign, text = item[len(head) :].partition("=")
        name = head + rest
        if not sign or not name or not (text or empty):
            fault = Problem(f"{what} '{item}'", "no name and value", f"{what} NAME=VALUE", f"for example {example}")
            raise SymofrosError(fault)
        stated[name.strip()] = text.strip()
    return stated


def reads_models(command: _Command) -> _Command:
    """Give a command the options of reading, in the place of its parameter `reading`."""
    signature = inspect.signature(command, eval_str=True)
    parameters = [parameter for parameter in signature.parameters.values() if parameter.name != PARAMETER]
    keyword = inspect.Parameter.KEYWORD_ONLY
    for name, (kind, option) in _OPTIONS.items():
        default: Any = {bool: False, str: ""}.get(kind, [])
        parameters.append(inspect.Parameter(name, keyword, default=default, annotation=Annotated[kind, option]))

    @wraps(command)
    def wrapped(*args: Any, **given: Any) -> Any:
        stated = {name: given.pop(name) for name in _OPTIONS if name in given}
        return command(*args, **given, **{PARAMETER: reading_of(**stated)})

    positional = [p.replace(kind=keyword) if p.kind is not keyword else p for p in parameters]
    wrapped.__signature__ = signature.replace(parameters=positional)  # type: ignore[attr-defined]
    wrapped.__annotations__ = {p.name: p.annotation for p in positional} | {"return": signature.return_annotation}
    return wrapped  # type: ignore[return-value]
