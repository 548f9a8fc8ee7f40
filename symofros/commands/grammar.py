"""Wrong arguments of all commands are refused in four parts, what, found, rule, remedy, never by a traceback."""

from __future__ import annotations

import difflib
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import Any, ClassVar

import typer
from typer.core import TyperGroup

from symofros.errors import Problem, SymofrosError

# Typer's own copy of Click has no public types but this one's heirs.
_UsageError: Any = typer.BadParameter.__base__
_GIVEN = "symofros.arguments"
BAD_INPUT = 2
# What Typer lets a parameter state of the value beside its type.
_RULES_OF_VALUES = ("parser", "envvar", "exists", "writable", "resolve_path", "allow_dash", "path_type")
# Characters of a command's first sentence in a list, which is wrapped; Click cuts it to what a line holds.
_SUMMARY = 300


class Group(TyperGroup):
    """Group of commands that reports invalid arguments and the errors of its commands in four parts."""

    def parse_args(self, ctx: Any, args: list[str]) -> Any:
        """Options before the command."""
        ctx.meta.setdefault(_GIVEN, tuple(args))  # Shared with the contexts below.
        _take_as_written(self, ctx)
        with _refusing():
            return super().parse_args(ctx, args)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """The command that arguments begin with."""
        name, command, rest = super().resolve_command(ctx, args)
        _take_as_written(command, ctx)
        return name, command, rest

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """The list of all commands in the help, each with its whole first sentence."""
        listed = ((name, self.get_command(ctx, name)) for name in self.list_commands(ctx))
        rows = [(name, command.get_short_help_str(limit=_SUMMARY)) for name, command in listed if command]
        with formatter.section("Commands"):
            formatter.write_dl(rows)

    def invoke(self, ctx: Any) -> Any:
        """Invoke a command; report the errors that it does not report itself, and exit."""
        try:
            with _refusing():
                return super().invoke(ctx)
        except BrokenPipeError:  # Whoever reads has seen enough; Typer ends quietly.
            raise
        except (SymofrosError, OSError) as error:
            raise import_module("symofros.commands.shared").refuse(error) from None


class TableGroup(Group, ABC):
    """Commands of a table; the module of a command is imported only when the command is used, not to list it."""

    table: ClassVar[Mapping[str, Any]]
    _listing = False

    @abstractmethod
    def made(self, name: str) -> Any:
        """Make a command of the table, which imports its module."""

    @abstractmethod
    def listed(self, name: str) -> Any:
        """Make a stand-in of a command for lists, with its name and help, without importing its module."""

    def list_commands(self, ctx: Any) -> list[str]:
        """Names of all commands, in the order of the table."""
        return [*self.table]

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """A command by its name, or its stand-in while commands are listed; None if the table has no such command."""
        if cmd_name not in self.table:
            return None
        return self.listed(cmd_name) if self._listing else self.made(cmd_name)

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the list of all commands to the help, without importing their modules."""
        with self._names_only():
            super().format_commands(ctx, formatter)

    def shell_complete(self, ctx: Any, incomplete: str) -> Any:
        """Completions of an incomplete argument, without importing the modules of commands."""
        with self._names_only():
            return super().shell_complete(ctx, incomplete)

    @contextmanager
    def _names_only(self) -> Iterator[None]:
        """Context in which commands are looked up only for lists, so that no module is imported."""
        self._listing = True
        try:
            yield
        finally:
            self._listing = False


def program(cls: type[Group] = Group, **settings: Any) -> typer.Typer:
    """A program whose help is plain text: markup would read units, "[s]", as styles, and state "<bool>" of flags."""
    return typer.Typer(cls=cls, rich_markup_mode=None, **settings)


class _AsWritten:
    """Parameter type that takes flags and texts as written; only the texts of paths are converted."""

    def __init__(self, kind: type) -> None:
        self._kind = kind

    def coerce(self, value: Any, param: Any, ctx: Any) -> Any:
        """The value; None where there is none, and an empty list of a parameter that is repeated."""
        if self._kind is list:
            return [*(value or ())]
        return None if value is None else self._kind(value)


def _take_as_written(command: Any, context: Any) -> None:
    """Let a command's flags, texts and paths be taken as they are written.

    Typer would convert them by pydantic, whose import takes longer than all else that `symofros compile` does where a
    model is in the cache. It still converts parameters of other types, those that state more of their values, and all
    where a version of it keeps its converters elsewhere.
    """
    for param in command.get_params(context):
        descriptor = getattr(param, "type_descriptor", None)
        kind, stated = getattr(descriptor, "annotation", None), getattr(descriptor, "parameter_info", None)
        kind = list if kind == list[str] else kind
        if kind in (bool, str, Path, list) and not any(getattr(stated, rule, None) for rule in _RULES_OF_VALUES):
            param._runtime_param = _AsWritten(kind)


@contextmanager
def _refusing() -> Iterator[None]:
    try:
        yield
    except _UsageError as error:
        context = error.ctx
        if context is None or type(error).__name__ == "NoArgsIsHelpError":  # The help is the answer.
            raise
        typer.echo(str(_problem(error, context)), err=True)
        raise typer.Exit(BAD_INPUT) from None


def _nearest(given: str, options: Iterable[str]) -> list[str]:
    """Options similar to the given one, sorted; leading dashes are ignored in the comparison."""
    names = {option.strip("-"): option for option in options}
    return sorted(names[name] for name in difflib.get_close_matches(given.strip("-"), names))


def _problem(error: Any, context: Any) -> Problem:
    path = context.command_path
    near = _nearest(getattr(error, "option_name", ""), getattr(error, "possibilities", None) or ())
    usage = " ".join(context.get_usage().removeprefix("Usage:").split())
    # Click would append its own suggestions.
    message = error.message if hasattr(error, "possibilities") else error.format_message()
    remedy = f"did you mean {' or '.join(near)}?" if near else f"'{path} --help' lists what it takes"
    given = " ".join(context.meta.get(_GIVEN, ())) or "no arguments"
    return Problem(f"{path}: {message[:1].lower()}{message[1:].rstrip('.')}", given, usage, remedy)
