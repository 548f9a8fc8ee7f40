"""From a URDF file to C99 that needs nothing else: export, build with the system's compiler, run its self-test."""

import subprocess
import tempfile
from pathlib import Path

import symofros as sf

URDF = """
<robot name="reacher">
  <link name="base"/>
  <link name="upper">
    <inertial><origin xyz="0.2 0 0"/><mass value="2"/>
      <inertia ixx="0.01" iyy="0.05" izz="0.05" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <link name="lower">
    <inertial><origin xyz="0.15 0 0"/><mass value="1"/>
      <inertia ixx="0.005" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper"/><axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="40" velocity="3"/>
  </joint>
  <joint name="elbow" type="revolute">
    <parent link="upper"/><child link="lower"/><origin xyz="0.4 0 0"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="20" velocity="3"/>
  </joint>
</robot>
"""

with tempfile.TemporaryDirectory() as folder:
    robot = Path(folder, "reacher.urdf")
    robot.write_text(URDF)
    system = sf.load(robot)
    print("remarks of the reader:", *(system.notes or ["none"]))
    package = Path(folder, "c")
    written = sf.export(system, "c", package)
    print("written:", *sorted(path.name for path in written.files))
    source = next(package.glob("reacher.c")).read_text()
    print(f"{len(source.splitlines())} lines of C for the model")
    build = "cc -std=c99 -O2 *.c -lm -o example && ./example 0.2"
    print(subprocess.run(build, shell=True, cwd=package, capture_output=True, text=True, check=True).stdout)
