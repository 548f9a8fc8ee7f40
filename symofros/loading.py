"""Files to systems and back: every fault of reading and of the mechanism in one error."""

from __future__ import annotations

import difflib
import os
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from symofros.base.arguments import checked
from symofros.base.sources import Source as Source
from symofros.base.stored import write_atomically
from symofros.description.imported.options import SNAP_TOL, ImportOptions
from symofros.description.imported.options import Dissipation as Dissipation
from symofros.description.imported.options import LimitsAs as LimitsAs
from symofros.description.packages import Folders, Packages
from symofros.description.reading import MODEL_SUFFIXES, USD_SUFFIXES, YAML_SUFFIXES, Reading, in_order
from symofros.description.remarks import note
from symofros.description.system import WAIVERS, System
from symofros.description.urdf.reader import read_urdf
from symofros.errors import Argument, DescriptionError, Problem, did_you_mean
from symofros.mechanics.topology.events import find_problems
from symofros.mechanics.topology.graph import name_problems
from symofros.mechanics.topology.numbers import Numbers
from symofros.mechanics.topology.physics import has_physical_inertia
from symofros.mechanics.topology.remarks import remarks
from symofros.mechanics.topology.units import unit_problems

_PATHS = "check the path; a relative one starts at the current folder"
_READABLE = (*MODEL_SUFFIXES, ".xacro", ".world")
_URDF, _SDF = (".urdf", ".xacro"), (".sdf", ".world")
_IMPORTED = (*_URDF, *_SDF, ".xml", *USD_SUFFIXES)
_ALL_IMPORTED = "URDF, xacro, SDF, MJCF and USD"
_UNASKED: tuple[Any, ...] = (None, False, {}, "data")
# Argument -> formats that have a use for it, their suffixes, what to do about another.
_FORMAT_OPTIONS = {
    "floating_base": (_ALL_IMPORTED, _IMPORTED, "give the base a free joint in the file"),
    "dissipation": (_ALL_IMPORTED, _IMPORTED, "state dampers and friction among the elements of the joints"),
    "limits": (_ALL_IMPORTED, _IMPORTED, "state stops among the elements of the joints"),
    "mimic": ("URDF", _URDF, "leave it out"),
    "arguments": ("xacro", (".xacro",), "leave it out"),
    "packages": ("URDF, xacro, SDF and MJCF", (*_URDF, *_SDF, ".xml"), "leave it out, or put the files in one folder"),
}


@checked
def load(
    path: str | os.PathLike[str],
    *,
    floating_base: bool = False,
    snap_tol: float = SNAP_TOL,
    waive: Collection[str] = (),
    mimic: bool = False,
    arguments: Mapping[str, str] | None = None,
    packages: Mapping[str, str | os.PathLike[str]] | None = None,
    dissipation: Dissipation | None = None,
    limits: LimitsAs = "data",
) -> System:
    """Read a description and check it.

    Files that a description names are read from its own folder, or its package, and from neighbours of that which a
    package.xml, model.config or model.sdf declares to be packages or models; `packages` adds to these.

    Args:
        path: Native YAML (.yaml, .yml), URDF (.urdf), xacro (.xacro; needs the package xacro), SDFormat (.sdf,
            .world), MJCF (.xml; needs the package mujoco) or USD (.usd, .usda, .usdc, .usdz; needs usd-core).
        floating_base: All but YAML: put the body that stands on the ground onto a free joint.
        snap_tol: All but YAML: numbers this close to exact ones are made exact (`ImportOptions`).
        waive: Checks that every body is allowed to fail (WAIVERS), such as "massless_tip".
        mimic: URDF only: couple joints that mimic others to them (`Coupling`); otherwise they stay independent.
        arguments: xacro only: values of its <xacro:arg>.
        packages: Name -> further folder that the description's files may be read from: packages of xacro and URDF by
            their names, models of SDFormat or folders that hold some; of MJCF under any name. Not for YAML and USD.
        dissipation: All but YAML: what of the file's passive losses is kept: "none"; "viscous", its dampers; "all", dry
            friction too, as smoothed Coulomb friction; "stiction", dry friction that holds joints at rest in runs. By
            default "none" of URDF, and "viscous" of the others.
        limits: All but YAML: "data", or "stops": limits of coordinates push back, as hard as the inertias suggest.

    Returns:
        The system; its `notes` say what an importer ignored or changed, where units of formulas do not fit, and which
        matrices of few digits were replaced by the nearest rotations.

    Raises:
        DescriptionError: With every problem of the file and of the mechanism it describes.
        ArgumentError: `dissipation`, `limits` or `snap_tol` is none of its choices.
    """
    asked = Asked(floating_base, snap_tol, mimic, dissipation, limits, arguments or {}, packages or {})
    return _checked(_waived(_read(Path(path), asked), waive))[0]


@dataclass(frozen=True)
class Asked(ImportOptions):
    """Options for reading a file, as those of `load`."""

    arguments: Mapping[str, str] = field(default_factory=dict)
    packages: Folders = field(default_factory=dict)


def load_with_sources(
    path: str | os.PathLike[str], waive: Collection[str] = (), **asked: Any
) -> tuple[System, tuple[Source, ...]]:
    """The system of `load`, and all files that it was made of; none where a package reads them, which does not tell.

    Args:
        path: The file.
        waive: As of `load`.
        asked: Fields of `Asked`.

    Raises:
        DescriptionError: As for `load`.
    """
    return _checked(_waived(_read(Path(path), Asked(**asked)), waive))


def _checked(reading: Reading) -> tuple[System, tuple[Source, ...]]:
    """The system that was read, with remarks among its notes, and its source files.

    Raises:
        DescriptionError: With every problem of the file and of the mechanism.
    """
    problems = find_problems(reading.system, reading.broken) if reading.system is not None else []
    if reading.problems or problems or reading.system is None:
        raise DescriptionError(in_order([*reading.problems, *problems]))
    system = reading.system
    units = [f"{problem.what}: {problem.found}; {problem.rule}" for problem in unit_problems(system)]
    noted = [*units, *remarks(system)]
    return replace(system, notes=(*system.notes, *noted)) if noted else system, reading.sources


def applicable(path: Path, arguments: Mapping[str, Any]) -> dict[str, Any]:
    """Arguments of `load` that the format of a file has a use for."""
    suffix, every = path.suffix.lower(), ("", _READABLE, "")
    return {name: value for name, value in arguments.items() if suffix in _FORMAT_OPTIONS.get(name, every)[1]}


def check_waivers(waive: Collection[str]) -> None:
    """Refuse checks that do not exist.

    Raises:
        DescriptionError: There is no such check.
    """
    for unknown in sorted(set(waive) - WAIVERS.keys()):
        raise DescriptionError(
            f"waive: no check '{unknown}'",
            f"'{unknown}'",
            f"one of {', '.join(WAIVERS)}",
            did_you_mean(unknown, WAIVERS),
        )


def _waived(reading: Reading, waive: Collection[str]) -> Reading:
    check_waivers(waive)
    if reading.system is None or not waive:
        return reading
    bodies = tuple(replace(body, waive=(*body.waive, *waive)) for body in reading.system.bodies)
    return replace(reading, system=replace(reading.system, bodies=bodies))


def _read(file: Path, asked: Asked) -> Reading:
    if file.is_dir():
        raise DescriptionError(_folder(file))
    if file.suffix or file.exists():
        _refuse_suffix(file, _READABLE, "read")
    if not file.exists():
        raise DescriptionError(_missing(file))
    suffix = file.suffix.lower()
    _refuse_idle(file, suffix, asked)
    if suffix in _IMPORTED:
        try:
            return _accept_inertias(_imported(file, suffix, asked))
        except DescriptionError as error:
            return Reading(None, error.problems)
    from symofros.description.yaml.files import read_yaml  # No foreign format waits for it: pydantic takes 0.2 s.

    return read_yaml(file)


def _imported(file: Path, suffix: str, asked: Asked) -> Reading:
    """A file of a foreign format.

    Raises:
        DescriptionError: It can't be read.
    """
    packages = Packages(file, asked.packages)
    if suffix in _URDF:
        text = None
        if suffix == ".xacro":
            from symofros.description.urdf.xacro_files import expanded  # As other readers, below.

            text = expanded(file, asked.arguments, packages)
        return read_urdf(file, asked, text=text, packages=packages)
    if suffix == ".xml":
        from symofros.description.mjcf.reader import read_mjcf  # No format waits for the reader of another.

        return read_mjcf(file, asked, packages=packages)
    if suffix in _SDF:
        from symofros.description.sdf.reader import read_sdf  # As above.

        return read_sdf(file, asked, packages=packages)
    from symofros.description.usd.reader import read_usd  # As above.

    return read_usd(file, asked)


def _refuse_idle(file: Path, suffix: str, asked: Asked) -> None:
    """Refuse arguments that the file's format has no use for.

    Raises:
        DescriptionError: There is one.
    """
    for name, (formats, suffixes, remedy) in _FORMAT_OPTIONS.items():
        if getattr(asked, name) not in _UNASKED and suffix not in suffixes:
            rule = "other descriptions state it themselves, or have no such thing"
            argument = Argument(name, key="NAME" if name in ("arguments", "packages") else "")
            what = f"{name} applies to {formats} files only"
            raise DescriptionError(what, f"'{file}'", rule, remedy, argument=argument)


@checked
def save(system: System, path: str | os.PathLike[str]) -> None:
    """Write a system as native YAML; the file is there whole or not at all.

    Args:
        system: What to write.
        path: Ends in .yaml or .yml.

    Raises:
        DescriptionError: Another suffix, or something that the format can't hold.
        OSError: The folder can't be written to.
    """
    file = Path(path)
    _refuse_suffix(file, YAML_SUFFIXES, "written")
    from symofros.description.yaml.yaml_writer import write_yaml  # As above; nor does who reads wait for a writer.

    if problems := name_problems(system):
        raise DescriptionError(problems)
    write_atomically(file, write_yaml(system))


# Formats that people have and we do not read -> how they become one that we do.
_CONVERSIONS = {
    ".mjb": "give the XML that the binary was compiled from",
}


def _refuse_suffix(file: Path, known: tuple[str, ...], verb: str) -> None:
    if file.suffix.lower() not in known:
        raise DescriptionError(
            f"'{file}' can't be {verb}: unknown format",
            file.suffix or "no suffix",
            f"the suffix is one of {', '.join(known)}",
            _CONVERSIONS.get(file.suffix.lower()) or _meant(file.suffix.lower(), known),
        )


def _meant(suffix: str, known: tuple[str, ...]) -> str:
    """The suffix that one letter or two away stands for; a text of another kind is no misspelt model."""
    near = difflib.get_close_matches(suffix, known, n=1, cutoff=0.75)
    return f"did you mean '{near[0]}'?" if near else "give a model: native YAML, URDF, SDF, MJCF or USD"


def _there(folder: Path) -> list[str]:
    """Names of the descriptions in a folder."""
    return sorted(other.name for other in folder.iterdir() if other.suffix.lower() in _READABLE)


def _folder(folder: Path) -> Problem:
    try:
        there = _there(folder)
    except OSError:
        there = []
    inside = f"in it: {', '.join(there[:12])}" if there else "no description in it"
    remedy = f"for example {folder / there[0]}" if there else _PATHS
    return Problem(f"'{folder}' is a folder", inside, "a description is one file", remedy)


def _missing(file: Path) -> Problem:
    if file.is_symlink():
        found, rule = "a link that leads nowhere", "a description is an existing file"
        return Problem(f"'{file}' can't be read", found, rule, "mend the link")
    try:
        there = _there(file.parent)
    except OSError:
        return Problem(
            f"'{file}' does not exist",
            f"nor does the folder '{file.parent}'",
            "a description is an existing file",
            _PATHS,
        )
    neighbours = f"in its folder: {', '.join(there[:12])}" if there else "no description in its folder"
    return Problem(
        f"'{file}' does not exist",
        neighbours,
        "a description is an existing file",
        did_you_mean(file.name, there) or _PATHS,
    )


def _accept_inertias(reading: Reading) -> Reading:
    """Waive the check of inertias that an imported file states although no mass distribution has them.

    Real robots' files have such; a model of the file as it stands is what a comparison with other engines needs.
    """
    system = reading.system
    if system is None:
        return reading
    numbers = Numbers(system)
    odd = {body.name for body in system.bodies if not has_physical_inertia(body, numbers)}
    if not odd:
        return reading
    waived = [replace(b, waive=(*b.waive, "nonphysical_inertia")) if b.name in odd else b for b in system.bodies]
    names = [body.name for body in system.bodies if body.name in odd]
    remark = note("non-physical inertias accepted as the file states them", "link", names)
    return replace(reading, system=replace(system, bodies=tuple(waived), notes=(*system.notes, remark)))
