# frax 0.1.0, cylindrical: jacfwd of rnea raises (derivative of M a + h by q).
import os
import numpy as np
import tempfile
os.environ["JAX_ENABLE_X64"] = "1"
os.environ["FRAX_SUPPRESS_WARNINGS"] = "1"
import jax
jax.config.update("jax_enable_x64", True)
from frax import Robot
URDF = """<robot name="tree">
<link name="world"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<link name="a"><inertial><origin xyz="-0.13419867674521718 -0.11472547338060726 -0.18601386937892445"/><mass value="1.2007032844965815"/>
<inertia ixx="0.13208021922460925" ixy="-0.00194858921472756" ixz="-0.0033654364148290655" iyy="0.12116951731811891" iyz="-0.00506688374908115" izz="0.11104163364095776"/></inertial></link>
<joint name="joint_a" type="continuous"><parent link="world"/><child link="a"/>
<origin xyz="-0.08333016134072069 0.44545324581520107 0.3467511691709766" rpy="-0.38409922007813313 -0.022206468079289395 2.248969902665347"/>
<axis xyz="1.0 0.0 0.0"/>
</joint>
<link name="b_0"/>
<joint name="joint_b_0" type="prismatic"><parent link="a"/><child link="b_0"/>
<origin xyz="-0.13589191516149657 0.41772659811470103 -0.3755103633341549" rpy="1.1232145030620815 0.706500785825651 -3.0867548223699535"/>
<axis xyz="0.0 0.0 1.0"/>
<limit lower="-100" upper="100" effort="1e9" velocity="1e9"/>
</joint>
<link name="b"><inertial><origin xyz="-0.08951961491047707 0.1771872147973313 0.09950874500283613"/><mass value="1.8050498650863074"/>
<inertia ixx="0.07660524311513568" ixy="-0.03177049614839142" ixz="-0.0018473777703521053" iyy="0.08044254298170378" iyz="-0.0025766125632981974" izz="0.11575108935347947"/></inertial></link>
<joint name="joint_b" type="continuous"><parent link="b_0"/><child link="b"/>
<origin xyz="0.0 0.0 0.0" rpy="0.0 0.0 0.0"/>
<axis xyz="0.0 0.0 1.0"/>
</joint>
<link name="c"><inertial><origin xyz="0.08887650786554724 0.0008459809999371015 -0.19640186876243557"/><mass value="0.7065993358989977"/>
<inertia ixx="0.1379110407484619" ixy="-0.00419855519392894" ixz="0.0005035950838836551" iyy="0.15409257780311417" iyz="0.0015310854053963902" izz="0.13866997462991332"/></inertial></link>
<joint name="joint_c" type="continuous"><parent link="b"/><child link="c"/>
<origin xyz="-0.22098776690669286 -0.40136792340203997 0.16465595722865534" rpy="-1.048540690083076 0.2862262713876837 1.6921371548928639"/>
<axis xyz="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/>
</joint>
</robot>"""
with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
    file.write(URDF)
    file.flush()
    robot = Robot(file.name, joint_ordering=['joint_a', 'joint_b_0', 'joint_b', 'joint_c'], floating_base=None)

def rates(q):
    if len(q) == 4: return np.eye(len(q))
    w, x, y, z = q[3:7]
    N = np.zeros((len(q), len(q) - 1))
    N[:3, :3], N[7:, 6:] = np.eye(3), np.eye(len(q) - 7)
    N[3:7, 3:6] = np.array([[-x, -y, -z], [w, -z, y], [z, w, -x], [-y, x, w]]) / 2
    return N
