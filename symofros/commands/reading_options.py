"""Options by which commands and the plug-in for pytest read models: one field an option, with how it is stated.

Nothing heavy is imported here: pytest loads it with the plug-in, `symofros compile` where the cache knows its answer.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import Field, dataclass, field, fields, replace
from pathlib import Path
from typing import Any

from symofros.errors import SymofrosError

_URDF = (".urdf", ".xacro")
_WITH_PACKAGES = (*_URDF, ".sdf", ".world", ".xml")
_FOREIGN = (*_WITH_PACKAGES, ".usd", ".usda", ".usdc", ".usdz")


def _option(default: Any, flag: str, text: str, metavar: str | None = None, formats: tuple[str, ...] = ()) -> Any:
    """A field that is stated as an option.

    Args:
        default: False of a switch, "" of a word, () of an option that is repeatable.
        flag: Name of the option behind its prefix.
        text: Help.
        metavar: What the help calls its value.
        formats: Suffixes of the files that have a use for it; empty: all.
    """
    return field(default=default, metadata={"flag": flag, "help": text, "metavar": metavar, "formats": formats})


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

    floating_base: bool = _option(
        False, "floating-base", "Put the body that stands on the ground onto a free joint.", formats=_FOREIGN
    )
    mimic: bool = _option(False, "mimic", "Couple the joints of a URDF that mimic others to them.", formats=_URDF)
    waive: tuple[str, ...] = _option(
        (), "waive", "A check that every body may fail, such as massless_tip; repeatable.", "CHECK"
    )
    packages: tuple[tuple[str, str], ...] = _option(
        (),
        "package",
        "A further folder that the model's files may be read from, by the name they give it; repeatable.",
        "NAME=FOLDER",
        _WITH_PACKAGES,
    )
    arguments: tuple[tuple[str, str], ...] = _option(
        (), "argument", "An argument of a xacro file; repeatable.", "NAME=VALUE", (".xacro",)
    )
    dissipation: str = _option(
        "",
        "dissipation",
        "What to keep of a file's passive losses: none (as of URDF by default), viscous (dampers, as of MJCF, "
        "SDF and USD), all (dry friction, too), or stiction (dry friction that holds joints at rest).",
        "WHAT",
        _FOREIGN,
    )
    limits: str = _option(
        "", "limits", "What limits of coordinates are: data (the default), or stops that push back.", "HOW", _FOREIGN
    )
    prefix: str = "--"

    @property
    def keywords(self) -> dict[str, Any]:
        """The stated options as keyword arguments of `sf.load`."""
        stated = {option.name: value for option in OPTIONS if (value := getattr(self, option.name))}
        mappings = {name: dict(stated[name]) for name in ("packages", "arguments") if name in stated}
        return stated | mappings

    def fit_for(self, path: Path) -> ReadingOptions:
        """A copy for one of several files of different formats, without the options that its format lacks."""
        suffix = path.suffix.lower()
        formats = {option.name: option.metadata["formats"] for option in OPTIONS}
        return self.without([name for name, suffixes in formats.items() if suffixes and suffix not in suffixes])

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
            raise SymofrosError(f"options of reading: {why}", stated, rule, "leave them out")


OPTIONS: tuple[Field[Any], ...] = tuple(item for item in fields(ReadingOptions) if item.metadata)
