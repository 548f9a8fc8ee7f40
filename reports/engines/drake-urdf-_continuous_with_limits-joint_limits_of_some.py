# drake 1.51.1, urdf: continuous with limits: GetPositionLowerLimits, GetPositionUpperLimits is wrong (the same where not all joints have limits: zeros for none).
import numpy as np
import pydrake.all as drake
p = drake.MultibodyPlant(0.0)
drake.Parser(p).AddModelsFromString('<robot name="r"><link name="world" /><link name="a"><inertial><origin xyz="0.1 -0.2 0.3" /><mass value="2" /><inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.4" /></inertial></link><link name="b"><inertial><origin xyz="0 0.1 0.2" /><mass value="1" /><inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.4" /></inertial></link><joint name="joint_a" type="revolute"><parent link="world" /><child link="a" /><origin xyz="0.1 0.2 0.3" rpy="0.3 -0.4 0.5" /><axis xyz="0 0 1" /><limit lower="-9" upper="9" effort="9" velocity="9" /></joint><joint name="joint_b" type="continuous"><parent link="a" /><child link="b" /><origin xyz="0 0 0.5" /><axis xyz="0 1 0" /><limit lower="-9" upper="9" effort="9" velocity="9" /></joint></robot>', 'urdf')
p.Finalize()
links = [p.GetBodyByName(name) for name in ['a', 'b']]
c = p.CreateDefaultContext()
x, value = np.c_[p.GetPositionLowerLimits(), p.GetPositionUpperLimits()], np.zeros((p.num_velocities(), 2))
for j in (p.get_joint(k) for k in p.GetJointIndices()):
    if j.num_positions() == j.num_velocities():
        own = x[j.position_start() : j.position_start() + j.num_positions()]
        value[j.velocity_start() : j.velocity_start() + len(own)] = np.where(np.isfinite(own), own, 0.0)
import numpy as np
value, expected = np.reshape(value, (2, 2))[(1, 0)], 0.0
assert abs(value - expected) <= 9.0e-12, f"{value = }, {expected = }"
