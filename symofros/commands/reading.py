"""How a model is read, as commands state it: the arguments of `sf.load` as options, defined once for all commands.

What `symofros compile` does where the cache knows its answer imports this: nothing here reads models.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterable
from functools import wraps
from typing import Annotated, Any, TypeVar

import typer

from symofros.base.names import QUOTED_NAME, name_of
from symofros.commands.reading_options import OPTIONS as OPTIONS
from symofros.commands.reading_options import ReadingOptions as ReadingOptions
from symofros.errors import Problem, SymofrosError

_Command = TypeVar("_Command", bound=Callable[..., Any])
# Parameter of a command that takes all options below.
PARAMETER = "reading"
_QUOTED = re.compile(QUOTED_NAME, re.ASCII)


def reading_of(*, prefix: str = "--", **stated: Any) -> ReadingOptions:
    """Options as they are stated, NAME=TEXT where they are pairs.

    Args:
        prefix: Beginning of the options' names, for the problem.
        stated: Fields of `ReadingOptions`; lists of texts where these are tuples.

    Raises:
        SymofrosError: A text is no pair, or two have one name.
    """
    named = _named(pairs(stated.get("packages", ()), f"{prefix}package", "hand_description=../hand_description"))
    given = _named(pairs(stated.get("arguments", ()), f"{prefix}argument", "gripper=true", empty=True))
    tuples = {"packages": named.items(), "arguments": given.items(), "waive": stated.get("waive", ())}
    return ReadingOptions(**stated | {name: tuple(items) for name, items in tuples.items()}, prefix=prefix)


def _named(stated: dict[str, str]) -> dict[str, str]:
    """The pairs, with backquotes removed from their names; the texts are unchanged."""
    return {name_of(name): text for name, text in stated.items()}


def pairs(given: Iterable[str], what: str, example: str, *, empty: bool = False) -> dict[str, str]:
    """NAME=TEXT options as a mapping; a name that holds an equals sign stands between backquotes, which it keeps.

    Args:
        given: The texts.
        what: Name of the option, for the problem.
        example: A pair, for the remedy.
        empty: Whether a text may be empty, as that of an argument of xacro.

    Raises:
        SymofrosError: A text is no pair, or two have one name.
    """
    stated: dict[str, str] = {}
    for item in given:
        begin = _QUOTED.match(item)
        head = begin.group() if begin else ""
        rest, sign, text = item[len(head) :].partition("=")
        name = head + rest
        if not sign or not name or not (text or empty):
            fault = Problem(f"{what} '{item}'", "no name and value", f"{what} NAME=VALUE", f"for example {example}")
            raise SymofrosError(fault)
        if (name := name.strip()) in stated:
            what, found = f"{what} {name} is stated twice", f"'{stated[name]}', '{text.strip()}'"
            raise SymofrosError(what, found, "a name has one value", "leave one out")
        stated[name] = text.strip()
    return stated


def reads_models(command: _Command) -> _Command:
    """Give a command the options of reading, in the place of its parameter `reading`."""
    signature = inspect.signature(command, eval_str=True)
    parameters = [parameter for parameter in signature.parameters.values() if parameter.name != PARAMETER]
    keyword = inspect.Parameter.KEYWORD_ONLY
    for item in OPTIONS:
        repeatable, stated_as = item.default == (), item.metadata
        kind: Any = list[str] if repeatable else type(item.default)
        default: Any = [] if repeatable else item.default
        flag, shown = f"--{stated_as['flag']}", item.default != ""
        option = typer.Option(flag, metavar=stated_as["metavar"], help=stated_as["help"], show_default=shown)
        parameters.append(inspect.Parameter(item.name, keyword, default=default, annotation=Annotated[kind, option]))

    @wraps(command)
    def wrapped(*args: Any, **given: Any) -> Any:
        stated = {item.name: given.pop(item.name) for item in OPTIONS if item.name in given}
        return command(*args, **given, **{PARAMETER: reading_of(**stated)})

    positional = [p.replace(kind=keyword) if p.kind is not keyword else p for p in parameters]
    wrapped.__signature__ = signature.replace(parameters=positional)  # type: ignore[attr-defined]
    wrapped.__annotations__ = {p.name: p.annotation for p in positional} | {"return": signature.return_annotation}
    return wrapped  # type: ignore[return-value]
