# drake 1.51.1, mjcf: class within a class: range: GetPositionLowerLimits, GetPositionUpperLimits is wrong (the same where not all joints have limits: zeros for none).
import numpy as np
import pydrake.all as drake
p = drake.MultibodyPlant(0.0)
drake.Parser(p).AddModelsFromString('<mujoco model="m"><compiler angle="radian"/><default><default class="k"><joint range="-0.5 1.25"/><default class="p"/></default></default><worldbody><body name="a" pos="0.1 0.2 0.3" ><joint damping="0" stiffness="0" frictionloss="0" armature="0" type="hinge" axis="0 0 1" limited="false"/><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4"/><body name="b" pos="0 0 0.5" childclass="k"><joint axis="0 1 0" class="p"/><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4"/></body></body></worldbody></mujoco>', 'xml')
p.Finalize()
links = [p.GetBodyByName(name) for name in ['a', 'b']]
c = p.CreateDefaultContext()
x, value = np.c_[p.GetPositionLowerLimits(), p.GetPositionUpperLimits()], np.zeros((p.num_velocities(), 2))
for j in (p.get_joint(k) for k in p.GetJointIndices()):
    if j.num_positions() == j.num_velocities():
        own = x[j.position_start() : j.position_start() + j.num_positions()]
        value[j.velocity_start() : j.velocity_start() + len(own)] = np.where(np.isfinite(own), own, 0.0)
import numpy as np
value, expected = np.reshape(value, (2, 2))[(1, 1)], 1.25
assert abs(value - expected) <= 1.2e-12, f"{value = }, {expected = }"
