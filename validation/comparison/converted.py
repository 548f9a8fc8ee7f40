"""Ten robots in several formats, as converters make them: `python -m validation.comparison.converted`.

Robots are URDF files of `example-robot-data`. MJCF comes from MuJoCo's own compiler and from our export, USD from
`urdf-usd-converter` and `mujoco-usd-converter`, SDF from libsdformat (`gz sdf -p`, or a program of ten lines that calls
`sdf::readFile`). Each is compared with the URDF by `symofros diff`.
"""

from __future__ import annotations

import shlex
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Annotated, Any
from xml.etree import ElementTree

import typer

import symofros as sf

# Folder in example-robot-data -> whether the root floats in what is compared.
ROBOTS = {
    "panda_description/urdf/panda.urdf": False,
    "ur_description/urdf/ur5_robot.urdf": False,
    "z1_description/urdf/z1.urdf": False,
    "xarm_description/urdf/xarm7.urdf": False,
    "kinova_description/robots/kinova.urdf": False,
    "allegro_hand_description/urdf/allegro_left_hand.urdf": False,
    "go2_description/urdf/go2.urdf": True,
    "anymal_b_simple_description/robots/anymal.urdf": True,
    "solo_description/robots/solo12.urdf": True,
    "talos_data/robots/talos_reduced.urdf": True,
}
# Relative digits that a way keeps: MJCF of MuJoCo's writer has six, and inertias along axes of as many; USD has floats.
WAYS = {
    "our MJCF": 1e-9,
    "MuJoCo": 3e-5,
    "urdf-usd-converter": 3e-5,
    "mujoco-usd-converter": 3e-5,
    "libsdformat": 3e-5,
}


_BY_MUJOCO = """
import sys
import mujoco
urdf, written, floating = sys.argv[1:]
options = '<mujoco><compiler fusestatic="false" discardvisual="false" strippath="false"/></mujoco></robot>'
spec = mujoco.MjSpec.from_string(open(urdf).read().replace("</robot>", options))
if floating:
    spec.worldbody.first_body().add_freejoint()
spec.compile()
open(written, "w").write(spec.to_xml())
"""


def bare(urdf: Path, target: Path) -> Path:
    """The file without shapes, whose meshes converters would look for."""
    robot = ElementTree.parse(urdf).getroot()
    for link in robot.iterfind("link"):
        for name in ("visual", "collision"):
            for shape in link.findall(name):
                link.remove(shape)
    for name in ("gazebo", "transmission", "mujoco"):
        for element in robot.findall(name):
            robot.remove(element)
    target.write_text(ElementTree.tostring(robot, encoding="unicode"))
    return target


def by_mujoco(urdf: Path, folder: Path, floating: bool) -> Path:
    """What MuJoCo's compiler makes of it, as MuJoCo writes it."""
    written = folder / "mujoco.xml"
    command = [sys.executable, "-c", _BY_MUJOCO, str(urdf), str(written), "floating" if floating else ""]
    subprocess.run(command, check=True, capture_output=True)
    return written


def read(file: Path, floating: bool) -> sf.System:
    """A file with all that it states; joints that can't mimic as it says are independent."""
    asked: dict[str, Any] = {"dissipation": "all", "waive": ("massless_tip",)}
    asked |= {} if file.suffix == ".xml" else {"floating_base": floating}
    if file.suffix != ".urdf":
        return sf.load(file, **asked)
    try:
        return sf.load(file, **asked, mimic=True)
    except sf.DescriptionError:
        return sf.load(file, **asked)


def exported(urdf: Path, folder: Path, floating: bool) -> Path:
    """What our export makes of it."""
    system = read(urdf, floating)
    files = sf.export(system, "mjcf", folder / "mjcf").files
    return next(one for one in files if one.suffix == ".xml")


def by_program(command: str, source: Path, folder: Path) -> Path:
    """The USD that a converter writes."""
    subprocess.run([*shlex.split(command), str(source), str(folder)], check=True, capture_output=True)
    return next(one for one in sorted(folder.glob("*.usd*")))


def by_sdformat(command: str, urdf: Path, folder: Path) -> Path:
    """The SDF that libsdformat prints; it fuses links on fixed joints."""
    done = subprocess.run([*shlex.split(command), str(urdf)], check=True, capture_output=True, text=True)
    (folder / "sdformat.sdf").write_text(done.stdout)
    return folder / "sdformat.sdf"


def compared(urdf: Path, floating: bool, folder: Path, programs: dict[str, str]) -> Iterator[tuple[str, str]]:
    """Each way, and what `diff` says of it."""
    folder.mkdir(parents=True, exist_ok=True)
    source = bare(urdf, folder / "robot.urdf")
    makers: dict[str, Callable[[], Path]] = {
        "our MJCF": lambda: exported(source, folder, floating),
        "MuJoCo": lambda: by_mujoco(source, folder, floating),
        "urdf-usd-converter": lambda: by_program(programs["urdf-usd-converter"], source, folder / "usd"),
        "mujoco-usd-converter": lambda: by_program(
            programs["mujoco-usd-converter"], folder / "mujoco.xml", folder / "musd"
        ),
        "libsdformat": lambda: by_sdformat(programs["libsdformat"], source, folder),
    }
    for way, make in makers.items():
        if way in programs and not programs[way]:
            continue
        try:
            file = make()
            # URDF does not say whether its root is held; what libsdformat makes of it is not, unless it is the world.
            floats = floating or (way == "libsdformat" and 'link name="world"' not in source.read_text())
            found = sf.diff(read(source, floats), read(file, floats), tolerance=WAYS[way])
            yield way, "same" if found.same else str(found)
        except subprocess.CalledProcessError as error:
            yield way, f"the converter refuses: {str(error.stderr)[-300:]}"
        except (sf.SymofrosError, ValueError, RuntimeError, OSError) as error:
            yield way, f"{type(error).__name__}: {error}"


def main(
    robots: Annotated[Path, typer.Argument(help="Folder of example-robot-data's robots.")],
    folder: Annotated[Path, typer.Argument(help="Folder of what converters write.")],
    urdf_usd: Annotated[str, typer.Option(help="Command of urdf-usd-converter.")] = "urdf_usd_converter",
    mujoco_usd: Annotated[str, typer.Option(help="Command of mujoco-usd-converter.")] = "mujoco_usd_converter",
    sdformat: Annotated[str, typer.Option(help="Command that prints a URDF file as SDF.")] = "gz sdf -p",
) -> None:
    """Compare ten robots with what converters make of them."""
    programs = {"urdf-usd-converter": urdf_usd, "mujoco-usd-converter": mujoco_usd, "libsdformat": sdformat}
    for name, floating in ROBOTS.items():
        for way, said in compared(robots / name, floating, folder / Path(name).stem, programs):
            typer.echo(f"{Path(name).stem:20} {way:22} {said.splitlines()[0] if said else said}")
            for line in said.splitlines()[1:]:
                typer.echo(f"    {line}")
            sys.stdout.flush()


if __name__ == "__main__":
    typer.run(main)
