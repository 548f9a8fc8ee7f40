"""Each extra by itself: `pip install '.[extra]'` in a new environment, and the first thing that one does with it.

python .ci/extras.py plots fmi      # these
python .ci/extras.py --today        # another one each day, but for the largest
python .ci/extras.py --all          # every one, an hour and several GB
"""

from __future__ import annotations

import argparse
import datetime
import os
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PENDULUM, URDF, MJCF = (
    ROOT / "reference_models/rigid/pendulum.yaml",
    ROOT / "reference_models/arm.urdf",
    ROOT / "validation/corpus/creature.xml",
)
# Of some GB, or made of all others.
LARGE = ("torch", "engines", "engine-drake", "all", "dev")
_CHECK = f"symofros check {PENDULUM} --states 5 --workers 1 --report out"
_INTEROP = """python -c "
import symofros as sf, symofros.interop.{0} as framework
print(framework.{1}({2}))
" """
# 1: a cell of the engine is red, which is no fault of its extra.
_ENGINE = "symofros validation engines --engine {0} --kinds 'revolute x' --no-prove --report out || [ $? = 1 ]"
_EIGEN = """python -c "
import pathlib, sys
assert list(pathlib.Path(sys.prefix).rglob('eigen3/Eigen')), 'no Eigen'
" """
# A layer with one hinge, as USD's schema of physics has it.
_STAGE = """#usda 1.0
( metersPerUnit = 1
  upAxis = "Z" )
def Xform "arm" (prepend apiSchemas = ["PhysicsArticulationRootAPI"]) {
  def Xform "link" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]) {
    float physics:mass = 1
    float3 physics:diagonalInertia = (0.1, 0.1, 0.1)
  }
  def PhysicsRevoluteJoint "hinge" {
    rel physics:body1 = </arm/link>
    uniform token physics:axis = "Z"
  }
}
"""
_XACRO = """<robot name="r" xmlns:xacro="http://ros.org/wiki/xacro">
<xacro:property name="m" value="2"/>
<link name="base"/>
<link name="l">
<inertial><mass value="${m}"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
</link>
<joint name="q" type="continuous"><parent link="base"/><child link="l"/></joint></robot>"""
FILES = {"hinge.usda": _STAGE, "robot.urdf.xacro": _XACRO}

# What is tried of each extra, in an empty folder with FILES; `symofros` and `python` are those of its environment.
TRIALS: dict[str, tuple[str, ...]] = {
    "validation": (_CHECK,),
    "timing": (_CHECK, _EIGEN),
    "plots": (f"symofros simulate {PENDULUM} 0.1 --picture run.png",),
    "campaign": ("symofros validation campaign run --models pendulum --states 40 --workers 1 -o runs",),
    "sundials": (f"symofros simulate {PENDULUM} 0.1 --method cvode",),
    "parquet": (f"symofros simulate {PENDULUM} 0.1 -o run.parquet",),
    "network": (
        "python -c \"import symofros as sf, symofros.blocks as lib; d = sf.Diagram('d');"
        " d.add(lib.Constant(name='one', value=1.0));"
        " d.add(lib.ZenohPublisher(name='p', key='a/b', period=0.01), signal='one.y');"
        ' print(sf.Simulation(d).run(0.02).outcome.ok)"',
    ),
    "mjcf": (f"symofros info {MJCF}",),
    "xacro": ("symofros info robot.urdf.xacro",),
    "usd": ("symofros info hinge.usda",),
    "cuda": (f"symofros kernels {PENDULUM} --functions mass_matrix",),
    "zig": (f"symofros export {PENDULUM} --target wasm -o out",),
    "gui": (
        "python -c \"import symofros.studio.editor.command, symofros.studio.editor.server.app; print('served')\"",
        "symofros edit --help",
    ),
    "view": (
        "python -c \"import symofros as sf; s = sf.load('"
        f"{PENDULUM}'); sf.record(s, sf.simulate(sf.compile(s), t_end=0.1), 'run.html')\"",
    ),
    "video": (
        "python -c \"import symofros as sf; s = sf.load('"
        f"{PENDULUM}'); sf.record(s, sf.simulate(sf.compile(s), t_end=0.1), 'run.mp4')\"",
    ),
    "torch": (_INTEROP.format("torch", "Dynamics", f"sf.compile(sf.load('{URDF}'))"),),
    "jax": (_INTEROP.format("jax", "Dynamics", f"sf.compile(sf.load('{URDF}'))"),),
    "casadi": (_INTEROP.format("casadi", "Dynamics", f"sf.load('{URDF}')"),),
    "gymnasium": ('python -c "import symofros.interop.gymnasium as g; print(g.MechanismEnv)"',),
    "fmi": (f"symofros export {PENDULUM} --target fmu2 -o out",),
    "sections": (
        'python -c "import symofros as sf; S = sf.sections;'
        ' print(S.polygon(S.Material(E=1.0, G=0.4, rho=1.0), [(0, 0), (2, 0), (2, 1), (1, 1.5)]).GJ)"',
    ),
    "docs": ("python -m sphinx --version", 'python -c "import myst_nb, furo, ipykernel"'),
    "test": (f"python -m pytest -n 1 {ROOT}/tests/base {ROOT}/tests/expr",),
    "dev": ("ruff --version", "mypy --version", 'python -c "import playwright, wasmtime, jax"'),
    "release": ("python -m build --version", "twine --version", "cyclonedx-py --version"),
    "engines": (_ENGINE.format("adam --engine dart --engine drake"),),
    "all": (_CHECK, 'python -c "import viser, casadi, jax, gymnasium, fmpy, zenoh"'),
}
for _name in "adam dart drake dynibo frax idyntree mjx mujoco-warp newton pybullet roboticstoolbox sapien".split():
    TRIALS[f"engine-{_name}"] = (_ENGINE.format(_name),)
TRIALS["engine-basilisk"] = (_ENGINE.format("basilisk").replace("revolute x", "rotations"),)


def extras() -> tuple[str, ...]:
    """The extras of the distribution, in its order."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return tuple(project["optional-dependencies"])


def of_the_day(day: datetime.date) -> str:
    """One of the smaller extras, another each day."""
    small = [extra for extra in extras() if extra not in LARGE]
    return small[day.toordinal() % len(small)]


def tried(extra: str, folder: Path) -> bool:
    """Install an extra and try it; whether that works is said."""
    start = time.monotonic()
    environment = folder / "environment"
    subprocess.run([sys.executable, "-m", "venv", environment], check=True)
    programs = environment / "bin"
    variables = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    variables |= {"PATH": f"{programs}{os.pathsep}{os.environ['PATH']}", "SYMOFROS_CACHE": str(folder / "cache")}
    for name, text in FILES.items():
        (folder / name).write_text(text, encoding="utf-8")
    install = f"pip install -q '{ROOT}[{extra}]'"
    for command in (install, *TRIALS[extra]):
        done = subprocess.run(command, shell=True, cwd=folder, env=variables, capture_output=True, text=True)
        if done.returncode:
            print(f"{extra}: exit {done.returncode} of {command}\n{done.stdout}{done.stderr}", flush=True)
            return False
    print(f"{extra}: installed and tried in {time.monotonic() - start:.0f} s", flush=True)
    return True


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description="Install each extra by itself, and try it.")
    parser.add_argument("extras", nargs="*", metavar="EXTRA", choices=[*extras(), []])
    parser.add_argument("--today", action="store_true", help="another extra each day, but for the largest")
    parser.add_argument("--all", action="store_true", help="every extra")
    asked = parser.parse_args()
    chosen = extras() if asked.all else [*asked.extras, *([of_the_day(datetime.date.today())] if asked.today else [])]
    failed = []
    for extra in chosen:
        folder = Path(tempfile.mkdtemp(prefix="extra-"))
        try:
            failed += [] if tried(extra, folder) else [extra]
        finally:
            shutil.rmtree(folder, ignore_errors=True)
    print(
        f"{len(chosen) - len(failed)} of {len(chosen)} extras work by themselves"
        + "".join(f", not {x}" for x in failed)
    )
    return 1 if failed or not chosen else 0


if __name__ == "__main__":
    sys.exit(main())
