"""A small URDF robot as text, for tests of the reader."""

from __future__ import annotations

INERTIAL = (
    '<inertial><origin xyz="0.1 0 0" rpy="0 0 0.5"/><mass value="2"/>'
    '<inertia ixx="1" iyy="2" izz="2.5" ixy="0" ixz="0" iyz="0"/></inertial>'
)
# What stands inside of <robot>.
ROBOT = f"""
<link name="base"/>
<link name="upper">{INERTIAL}</link>
<link name="hand">{INERTIAL}</link>
<joint name="q1" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 0 2"/>
  <origin xyz="0 0 1" rpy="0 1.5707963267948966 0"/><limit lower="-1" upper="1" effort="5" velocity="2"/></joint>
<joint name="weld" type="fixed"><parent link="upper"/><child link="hand"/><origin xyz="0.5 0 0"/></joint>
"""
# The same with a finger that follows the shoulder.
MIMIC = f"""{ROBOT}<link name="finger">{INERTIAL}</link><joint name="q2" type="prismatic"><parent link="hand"/>
<child link="finger"/><axis xyz="0 1 0"/><limit lower="-9" upper="9" effort="9" velocity="9"/>
<mimic joint="q1" multiplier="-0.5" offset="0.2"/></joint>"""


def document(inside: str) -> str:
    """A whole file."""
    return f'<robot name="arm">{inside}</robot>'
