"""Files to systems and back: every fault of reading and of the mechanism in one error."""

from __future__ import annotations

import difflib
import os
from collections.abc import Collection, Mapping
from dataclasses import replace
from pathlib import Path

from symofros.base.arguments import checked
from symofros.base.atomic import write_atomically
from symofros.base.sources import Source
from symofros.description.reading import MODEL_SUFFIXES, USD_SUFFIXES, YAML_SUFFIXES, Reading, in_order
from symofros.description.remarks import note
from symofros.description.system import WAIVERS, System
from symofros.description.urdf.reader import SNAP_TOL, read_urdf
from symofros.errors import DescriptionError, Problem, did_you_mean
from symofros.mechanics.topology.graph import find_problems
from symofros.mechanics.topology.numbers import Numbers
from symofros.mechanics.topology.physics import has_physical_inertia
from symofros.mechanics.topology.remarks import rounded_rotations
from symofros.mechanics.topology.units import unit_problems

_PATHS = "check the path; a relative one starts at the current folder"
_READABLE = (*MODEL_SUFFIXES, ".xacro", ".world")


@checked
def load(
    path: str | os.PathLike[str],
    *,
    floating_base: bool = False,
    snap_tol: float = SNAP_TOL,
    waive: Collection[str] = (),
    mimic: bool = False,
    arguments: Mapping[str, str] | None = None,
) -> System:
    """Read a description and check it.

    Args:
        path: Native YAML (.yaml, .yml), URDF (.urdf), xacro (.xacro; needs the package xacro), SDFormat (.sdf,
            .world), MJCF (.xml; needs the package mujoco) or USD (.usd, .usda, .usdc, .usdz; needs usd-core).
        floating_base: URDF only: put a free joint under the root link.
        snap_tol: All but YAML: numbers this close to exact ones are made exact (`read_urdf`, `read_mjcf`).
        waive: Checks that every body is allowed to fail (WAIVERS), such as "massless_tip".
        mimic: URDF only: couple joints that mimic others to them (`Coupling`); otherwise they stay independent.
        arguments: xacro only: values of its <xacro:arg>.

    Returns:
        The system; its `notes` say what an importer ignored or changed, where units of formulas do not fit, and which
        matrices of few digits were replaced by the nearest rotations.

    Raises:
        DescriptionError: With every problem of the file and of the mechanism it describes.
    """
    return load_with_sources(path, floating_base, snap_tol, waive, mimic, arguments)[0]


def load_with_sources(
    path: str | os.PathLike[str],
    floating_base: bool = False,
    snap_tol: float = SNAP_TOL,
    waive: Collection[str] = (),
    mimic: bool = False,
    arguments: Mapping[str, str] | None = None,
) -> tuple[System, tuple[Source, ...]]:
    """The system of `load`, and all files that it was made of; none where a package reads them, which does not tell.

    Raises:
        DescriptionError: As for `load`.
    """
    file = Path(path)
    reading = _waived(_read(file, floating_base, snap_tol, mimic, arguments or {}), waive)
    problems = find_problems(reading.system, reading.broken) if reading.system is not None else []
    if reading.problems or problems or reading.system is None:
        raise DescriptionError(in_order([*reading.problems, *problems]))
    system = reading.system
    units = [f"{problem.what}: {problem.found}; {problem.rule}" for problem in unit_problems(system)]
    remarks = [*units, *rounded_rotations(system)]
    return replace(system, notes=(*system.notes, *remarks)) if remarks else system, reading.sources


def _waived(reading: Reading, waive: Collection[str]) -> Reading:
    for unknown in sorted(set(waive) - WAIVERS.keys()):
        raise DescriptionError(
            Problem(
                f"waive: no check '{unknown}'",
                f"'{unknown}'",
                f"one of {', '.join(WAIVERS)}",
                did_you_mean(unknown, WAIVERS),
            )
        )
    if reading.system is None or not waive:
        return reading
    bodies = tuple(replace(body, waive=(*body.waive, *waive)) for body in reading.system.bodies)
    return replace(reading, system=replace(reading.system, bodies=bodies))


def _read(file: Path, floating_base: bool, snap_tol: float, mimic: bool, arguments: Mapping[str, str]) -> Reading:
    if file.is_dir():
        raise DescriptionError(_folder(file))
    if file.suffix or file.exists():
        _refuse_suffix(file, _READABLE, "read")
    if not file.exists():
        raise DescriptionError(_missing(file))
    if file.suffix.lower() == ".urdf":
        return _accept_inertias(read_urdf(file, floating_base=floating_base, snap_tol=snap_tol, mimic=mimic))
    if file.suffix.lower() == ".xacro":
        from symofros.description.urdf.xacro_files import expanded

        text = expanded(file, arguments)
        reading = read_urdf(file, floating_base=floating_base, snap_tol=snap_tol, mimic=mimic, text=text)
        return _accept_inertias(reading)
    if floating_base:
        raise DescriptionError(
            Problem(
                "floating_base applies to URDF files only",
                f"'{file}'",
                "other descriptions state their joints",
                "give the base a free joint in the file",
            )
        )
    # A reader of another format is not loaded with the one that is asked for: pydantic alone takes a fifth of a second.
    if file.suffix.lower() == ".xml":
        from symofros.description.mjcf.reader import read_mjcf

        return _accept_inertias(read_mjcf(file, snap_tol=snap_tol))
    if file.suffix.lower() in (".sdf", ".world"):
        from symofros.description.sdf.reader import read_sdf

        return _accept_inertias(read_sdf(file, snap_tol=snap_tol))
    if file.suffix.lower() in USD_SUFFIXES:
        from symofros.description.usd.reader import read_usd

        return _accept_inertias(read_usd(file, snap_tol=snap_tol))
    from symofros.description.yaml.files import read_yaml

    return read_yaml(file)


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
    from symofros.description.yaml.yaml_writer import write_yaml

    write_atomically(file, write_yaml(system))


# Formats that people have and we do not read -> how they become one that we do.
_CONVERSIONS = {
    ".mjb": "give the XML that the binary was compiled from",
}


def _refuse_suffix(file: Path, known: tuple[str, ...], verb: str) -> None:
    if file.suffix.lower() not in known:
        raise DescriptionError(
            Problem(
                f"'{file}' can't be {verb}: unknown format",
                file.suffix or "no suffix",
                f"the suffix is one of {', '.join(known)}",
                _CONVERSIONS.get(file.suffix.lower()) or _meant(file.suffix.lower(), known),
            )
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
