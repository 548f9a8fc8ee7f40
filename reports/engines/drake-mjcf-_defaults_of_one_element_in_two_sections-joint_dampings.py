# drake 1.51.1, mjcf: defaults of one element in two sections: default_damping_vector is wrong (force of dampers for a unit of speed).
import numpy as np
import pydrake.all as drake
p = drake.MultibodyPlant(0.0)
drake.Parser(p).AddModelsFromString('<mujoco model="m"><compiler angle="radian"/><default><joint armature="0.25" damping="3"/></default><default><joint armature="0.5"/></default><worldbody><body name="a" pos="0.1 0.2 0.3" ><joint axis="0 0 1"/><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4"/><body name="b" pos="0 0 0.5" ><joint axis="0 1 0"/><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4"/></body></body></worldbody></mujoco>', 'xml')
p.Finalize()
links = [p.GetBodyByName(name) for name in ['a', 'b']]
c = p.CreateDefaultContext()
value = np.concatenate([p.get_joint(j).default_damping_vector() for j in p.GetJointIndices()])
import numpy as np
value, expected = np.reshape(value, (2,))[(0,)], 3.0
assert abs(value - expected) <= 3.0e-12, f"{value = }, {expected = }"
