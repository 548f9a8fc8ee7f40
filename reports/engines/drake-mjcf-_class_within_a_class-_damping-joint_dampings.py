# drake 1.51.1, mjcf: class within a class: damping: default_damping_vector is wrong (force of dampers for a unit of speed).
import numpy as np
import pydrake.all as drake
p = drake.MultibodyPlant(0.0)
drake.Parser(p).AddModelsFromString('<mujoco model="m"><compiler angle="radian"/><default><default class="k"><joint damping="3"/><default class="p"/></default></default><worldbody><body name="a" pos="0.1 0.2 0.3" ><joint damping="0" stiffness="0" frictionloss="0" armature="0" type="hinge" axis="0 0 1"/><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4"/><body name="b" pos="0 0 0.5" childclass="k"><joint axis="0 1 0" class="p"/><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4"/></body></body></worldbody></mujoco>', 'xml')
p.Finalize()
links = [p.GetBodyByName(name) for name in ['a', 'b']]
c = p.CreateDefaultContext()
value = np.zeros(p.num_velocities())
for j in map(p.get_joint, p.GetJointIndices()):
    value[j.velocity_start():][:j.num_velocities()] = j.default_damping_vector()
import numpy as np
value, expected = np.reshape(value, (2,))[(1,)], 3.0
assert abs(value - expected) <= 3.0e-12, f"{value = }, {expected = }"
