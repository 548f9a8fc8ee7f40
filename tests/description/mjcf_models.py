"""Small MJCF models, each with something that an importer can get wrong."""

from __future__ import annotations

# Name -> what stands inside of <mujoco>.
MODELS: dict[str, str] = {
    "degrees_and_euler_sequence": """
        <compiler angle="degree" eulerseq="zyx"/>
        <worldbody><body name="a" pos="0.1 0.2 0.3" euler="10 -20 30">
          <joint name="q1" axis="1 2 3" range="-90 45"/>
          <inertial pos="0.1 0 0.2" mass="2" fullinertia="0.3 0.4 0.5 0.01 -0.02 0.03"/>
          <body name="b" pos="0.5 0 0" axisangle="1 1 0 40">
            <joint name="q2" type="slide" axis="0 1 1"/>
            <inertial pos="0 0.1 0" quat="1 2 0 0" mass="1" diaginertia="0.1 0.2 0.25"/>
          </body></body></worldbody>""",
    "radian": """
        <compiler angle="radian"/>
        <worldbody><body name="a" euler="0.3 0.2 -0.1">
          <joint name="q1" axis="0 1 0" range="-1 1"/><geom type="box" size="0.1 0.2 0.3"/>
        </body></worldbody>""",
    "default_classes": """
        <default><joint damping="0.3" armature="0.02"/><geom density="500"/>
          <default class="stiff"><joint stiffness="7" axis="0 1 0"/>
            <default class="stiffer"><joint stiffness="70" damping="1"/></default></default></default>
        <worldbody><body name="a" childclass="stiff">
          <joint name="q1"/><geom type="ellipsoid" size="0.1 0.2 0.3"/>
          <body name="b" pos="1 0 0"><joint name="q2" class="stiffer"/><geom type="cylinder" size="0.1 0.2"/></body>
          <body name="c" pos="0 1 0"><joint name="q3" class="main"/><geom size="0.1"/></body>
        </body></worldbody>""",
    "inertia_of_capsules": """
        <worldbody><body name="a">
          <joint name="q1" axis="0 1 0"/>
          <geom type="capsule" fromto="0 0 0 0.4 0.1 0.2" size="0.05"/>
          <geom type="capsule" fromto="0 0 0 0 0.3 0" size="0.04" mass="0.7"/>
          <body name="b" pos="0.4 0.1 0.2"><joint name="q2" axis="0 0 1"/>
            <geom type="cylinder" fromto="0 0 0 0.3 0 0" size="0.03"/></body>
        </body></worldbody>""",
    "reference_and_spring_reference": """
        <compiler angle="degree"/>
        <worldbody><body name="a" pos="0 0 1" quat="1 1 0 0">
          <joint name="q1" axis="0 1 1" pos="0.1 0.2 0.3" ref="35" springref="-20" stiffness="5" damping="0.4"/>
          <geom size="0.2" pos="0.5 0 0"/>
          <body name="b" pos="0.4 0 0" euler="0 30 0">
            <joint name="q2" type="slide" axis="1 0 1" ref="0.7" springref="0.2" stiffness="11"/>
            <geom type="box" size="0.1 0.2 0.1"/></body>
        </body></worldbody>""",
    "several_joints_on_a_body": """
        <compiler angle="radian"/>
        <worldbody><body name="a" pos="1 2 3" euler="0.5 0 0.2">
          <joint name="x" type="slide" axis="1 0 0" ref="0.3"/>
          <joint name="z" type="slide" axis="0 1 1" pos="5 5 5"/>
          <joint name="turn" axis="0 1 0" pos="0.1 0 -0.2" ref="0.4"/>
          <geom type="capsule" size="0.1 0.4" pos="0.2 0 0"/>
          <body name="b" pos="0.3 0 0.1">
            <joint name="q1" axis="1 0 0" pos="0 0.1 0"/>
            <joint name="q2" axis="0 1 1" pos="0 0.1 0.2" ref="-0.6"/>
            <joint name="q3" axis="0 0 1" pos="0.3 0 0" armature="0.1"/>
            <geom type="box" size="0.1 0.2 0.3"/></body>
        </body></worldbody>""",
    "ball_joint": """
        <worldbody><body name="a" pos="0 0 1" euler="10 20 30">
          <joint name="shoulder" type="ball" pos="0.1 0.2 0" damping="0.6" armature="0.03"/>
          <geom type="box" size="0.1 0.2 0.3" pos="0.2 0 0"/>
          <body name="b" pos="0.4 0 0"><joint name="slide" type="slide"/><joint name="wrist" type="ball"/>
            <geom type="ellipsoid" size="0.1 0.2 0.15" pos="0.1 0 0"/></body>
        </body></worldbody>""",
    "free_joint": """
        <default><joint armature="0.5" damping="0.2"/></default>
        <worldbody><body name="torso" pos="0 0 1.3" euler="10 20 30">
          <freejoint name="root"/><geom type="box" size="0.1 0.2 0.3" pos="0.05 0 0"/>
          <body name="leg" pos="0 0.1 -0.3"><joint name="hip" axis="0 1 0"/>
            <geom type="capsule" size="0.05 0.2"/></body>
        </body>
        <body name="ball"><joint name="flying" type="free" armature="0" damping="0.7"/><geom size="0.1"/></body>
        </worldbody>""",
    "frames_and_replicas": """
        <compiler angle="radian"/>
        <default><default class="light"><geom density="10"/></default></default>
        <worldbody><frame pos="0 0 1" euler="0.1 0.2 0.3" childclass="light"><frame pos="1 0 0">
          <body name="a" quat="1 0 1 0"><joint name="q1" axis="0 0 1"/>
            <frame euler="0.5 0 0"><geom type="box" size="0.1 0.2 0.3" pos="0.1 0 0"/></frame>
            <replicate count="3" offset="0 0.2 0" euler="0.1 0 0"><body name="r" pos="0.3 0 0">
              <joint name="s" axis="1 0 0"/><geom type="capsule" size="0.03 0.1"/></body></replicate>
          </body></frame></frame></worldbody>""",
    "gravity_sites_and_welds": """
        <option gravity="1 2 -3"/>
        <worldbody><site name="mark" pos="0 0 2"/>
        <body name="base" pos="0 0 0.5"><geom size="0.3"/>
          <body name="a" pos="0 0 0.5"><joint name="q1" axis="0 1 0"/><geom type="box" size="0.1 0.2 0.3"/>
            <body name="welded" pos="0.2 0 0" euler="0 0 45"><geom type="box" size="0.3 0.1 0.1" pos="0.3 0 0"/>
              <site name="tip" pos="0.6 0 0" euler="0 90 0"/>
              <body name="b" pos="0.6 0 0"><joint name="q2" axis="1 0 0"/><geom type="box" size="0.1 0.1 0.2"/></body>
        </body></body></body></worldbody>""",
    "no_gravity_no_springs_no_dampers": """
        <option><flag gravity="disable" spring="disable" damper="disable"/></option>
        <worldbody><body name="a" gravcomp="1"><joint name="q1" axis="0 1 0" stiffness="3" damping="2"/>
          <geom type="box" size="0.1 0.2 0.3" pos="1 0 0"/></body></worldbody>""",
    "gravity_compensation": """
        <worldbody><body name="a" gravcomp="1"><joint name="q1" axis="0 1 0" actuatorgravcomp="true"/>
          <geom type="box" size="0.1 0.2 0.3" pos="1 0 0"/>
          <body name="b" pos="1 0 0" gravcomp="0.4"><joint name="q2" axis="0 1 0"/><geom size="0.1" pos="0.3 0 0.1"/>
          </body></body></worldbody>""",
    "nameless": """
        <worldbody><body><joint axis="0 1 0"/><joint axis="1 0 0"/><geom type="box" size="0.1 0.2 0.3" pos="1 0 0"/>
          <site pos="0 0 1"/>
          <body pos="1 0 0"><joint axis="0 1 0"/><geom type="box" size="0.1 0.2 0.3"/></body>
          <body name="c" pos="0 1 0"><joint name="q" axis="0 1 0"/><geom size="0.3"/></body>
        </body></worldbody>""",
    "higher_orders": """
        <worldbody><body name="a"><joint name="q1" axis="0 1 0" stiffness="3 0 8" damping="0.5 2"/>
          <geom type="box" size="0.1 0.2 0.3" pos="1 0 0"/></body></worldbody>""",
    "settings_of_the_compiler": """
        <compiler settotalmass="5" balanceinertia="true" boundmass="0.1" inertiafromgeom="true"/>
        <worldbody><geom type="plane" size="1 1 1"/><body name="a"><joint name="q1" axis="0 1 0"/>
          <inertial pos="9 9 9" mass="9" diaginertia="9 9 9"/>
          <geom type="box" size="0.1 0.2 0.3" pos="0.3 0 0"/></body></worldbody>""",
}


def document(body: str) -> str:
    """A whole file."""
    return f'<mujoco model="test">{body}</mujoco>'
