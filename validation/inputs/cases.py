"""What can be checked: files of the user, robots of the `example-robot-data` package, our reference models."""

from __future__ import annotations

import difflib
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

import symofros as sf
from symofros.commands.reading import ReadingOptions

from .. import references
from ..contract.interface import MjcfSource, Subject, UrdfSource

# How files are read unless options say more.
DEFAULT_READING = ReadingOptions()
ROBOT_PACKAGE = "example-robot-data"
# Work of a body, in bytes of a robot's file; of what a beam and a loop add, in bodies; of a byte of YAML, which states
# a body in fewer.
BODY, ELASTIC, LOOP, YAML = 1500, 8, 4, 4
_CORPUS = Path(__file__).parents[1] / "corpus"
# Our own files of what robots and reference models lack: kinds of joints, of shapes, ways to state them.
FILES = {
    "battery": "battery.yaml",
    "motors": "motors.yaml",
    "mirrored": "mirrored.yaml",
    "beam_zoo": "beam_zoo.yaml",
    "creature": "creature.xml",
    "sampler": "arm.urdf",
}


@dataclass(frozen=True)
class Case:
    """A model to be loaded; small and picklable, so that the process that checks it also reads it.

    Attributes:
        label: Name in tables.
        path: Path of its file; None for a reference model.
        reading: How the file is read.
    """

    label: str
    path: Path | None = None
    reading: ReadingOptions = DEFAULT_READING

    @property
    def weight(self) -> int:
        """A guess at the work it makes [bytes of a file]: large models first keep all workers busy to the end."""
        if self.path is not None:
            size = self.path.stat().st_size if self.path.is_file() else 0
            return YAML * size if self.path.suffix == ".yaml" else size
        if self.label not in references.MODELS:
            return 0  # `load` says what is wrong.
        system = references.MODELS[self.label]
        beams = sum(isinstance(body, sf.Beam) for body in system.bodies)
        return BODY * (len(system.bodies) + ELASTIC * beams + LOOP * len(system.constraints))

    def load(self) -> Subject:
        """Read it.

        Raises:
            DescriptionError: It is no legal description.
            OSError: The file can't be read.
        """
        if self.path is None:
            return Subject(self.label, references.MODELS[self.label])
        system = sf.load(self.path, **self.reading.keywords)
        suffix = self.path.suffix.lower()
        # An engine's own reading has the passive forces that it finds in the file, and no others.
        if suffix not in (".xml", ".urdf") or self.reading.changes_forces:
            return Subject(self.label, system)
        if suffix == ".xml" and self.reading.floating_base:
            return Subject(self.label, system)
        verbatim = sf.load(self.path, **self.reading.keywords, snap_tol=0.0)
        if suffix == ".xml":
            return Subject(self.label, system, mjcf=MjcfSource(self.path, verbatim))
        source = UrdfSource(self.path.read_bytes(), verbatim, self.reading.floating_base)
        return Subject(self.label, system, urdf=source)


@dataclass(frozen=True)
class Robot:
    """A robot of the package.

    Attributes:
        file: Path below the package's folder of robots.
        floating_base: Whether nothing holds its root.
        why: Reason why it is in the set.
    """

    file: str
    floating_base: bool
    why: str


ROBOTS: dict[str, Robot] = {
    "ur5": Robot("ur_description/urdf/ur5_robot.urdf", False, "arm, 6 revolute joints, angles given with ten digits"),
    "panda": Robot("panda_description/urdf/panda.urdf", False, "arm with a gripper of two prismatic joints"),
    "kinova": Robot("kinova_description/robots/kinova.urdf", False, "arm with continuous joints"),
    "xarm7": Robot("xarm_description/urdf/xarm7.urdf", False, "arm"),
    "allegro_hand": Robot("allegro_hand_description/urdf/allegro_right_hand.urdf", False, "hand, fingers of grams"),
    "baxter": Robot("baxter_description/urdf/baxter.urdf", False, "two arms and a head"),
    "anymal": Robot("anymal_b_simple_description/robots/anymal.urdf", True, "quadruped"),
    "solo12": Robot("solo_description/robots/solo12.urdf", True, "quadruped"),
    "hyq": Robot("hyq_description/robots/hyq_no_sensors.urdf", True, "quadruped"),
    "go1": Robot("go1_description/urdf/go1.urdf", True, "quadruped with rotors as bodies"),
    "bolt": Robot("bolt_description/robots/bolt.urdf", True, "biped"),
    "simple_humanoid": Robot("simple_humanoid_description/urdf/simple_humanoid.urdf", True, "humanoid"),
    "talos": Robot("talos_data/robots/talos_reduced.urdf", True, "humanoid, 38 speeds"),
    "g1": Robot("g1_description/urdf/g1_29dof_rev_1_0.urdf", True, "humanoid, 35 speeds"),
    "icub": Robot("icub_description/robots/icub.urdf", True, "humanoid; inertias that MuJoCo refuses"),
    "centauro": Robot("centauro_description/urdf/centauro.urdf", True, "four wheeled legs and two arms, 45 speeds"),
}


def standard_set() -> list[Case]:
    """The robots of the package, every reference model, and our own files.

    Raises:
        FileNotFoundError: The package is not installed, or lacks a file.
    """
    robots = (robot_case(label) for label in ROBOTS)
    return [*robots, *(Case(label) for label in references.MODELS), *map(file_case, FILES)]


def file_case(label: str) -> Case:
    """One of our own files."""
    return Case(label, _CORPUS / FILES[label])


def robot_case(label: str) -> Case:
    """A robot of the package, wherever it was installed.

    Raises:
        FileNotFoundError: The package is not installed, or lacks the file.
    """
    robot = ROBOTS[label]
    return Case(label, robot_file(robot.file), ReadingOptions(robot.floating_base))


def robot_file(name: str) -> Path:
    """A file of the package of robots.

    Args:
        name: Path below the package's folder of robots.

    Raises:
        FileNotFoundError: The package is not installed, or lacks the file.
    """
    try:
        files = metadata.distribution(ROBOT_PACKAGE).files or []
    except metadata.PackageNotFoundError:
        raise FileNotFoundError(
            f"{name}: package {ROBOT_PACKAGE} is not installed; pip install 'symofros[validation]'"
        ) from None
    for file in files:
        if file.as_posix().endswith(f"/robots/{name}"):
            return Path(str(file.locate()))
    raise FileNotFoundError(f"no {name} in package {ROBOT_PACKAGE}")


def named(names: list[str], reading: ReadingOptions = DEFAULT_READING) -> list[Case]:
    """The models that a user named: paths of files, or names of the standard set, all of which none is.

    Args:
        names: Names in the order of the report.
        reading: How files among them are read; what only URDF has is left out for others.

    Raises:
        LookupError: A name is neither.
        FileNotFoundError: A robot's package is not installed.
        SymofrosError: An option of reading fits none of the files, or waives a check that does not exist.
    """
    reading.check_waivers()
    if not names:
        reading.require_none("the models of the standard set are read as they are")
        return standard_set()
    cases = list(dict.fromkeys(_named(name, reading) for name in names))
    _refuse_idle(names, reading)
    labels = [case.label for case in cases]
    return [
        case
        if labels.count(case.label) == 1 or case.path is None
        else Case(f"{case.path.parent.name}/{case.path.name}", case.path, case.reading)
        for case in cases
    ]


def _refuse_idle(names: list[str], reading: ReadingOptions) -> None:
    """Refuse options that none of the files has a use for; models of the standard set are read as they are.

    Raises:
        SymofrosError: There are some.
    """
    files = (path for path in map(Path, names) if _is_file(path))
    used = {option for path in files for option in reading.fit_for(path).keywords}
    reading.without(used).require_none("none of the models named has a use for them")


def _is_file(path: Path) -> bool:
    """Whether a name is that of a file, there or not."""
    return bool(path.suffix) or path.exists()


def _named(name: str, reading: ReadingOptions) -> Case:
    path = Path(name)
    if _is_file(path):
        return Case(path.stem, path, reading.fit_for(path))
    if name in ROBOTS:
        return robot_case(name)
    if name in references.MODELS:
        return Case(name)
    if name in FILES:
        return file_case(name)
    known = [*ROBOTS, *references.MODELS, *FILES]
    near = difflib.get_close_matches(name, known, n=1)
    remedy = f"did you mean '{near[0]}'?" if near else f"the standard set has {', '.join(known)}"
    raise LookupError(f"'{name}' is neither a file nor a model of the standard set; {remedy}")
