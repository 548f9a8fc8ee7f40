# drake 1.51.1, mjcf: class within a class: axis: CalcInverseDynamics is wrong (h: Coriolis, centrifugal and gravity forces).
import numpy as np
import pydrake.all as drake
p = drake.MultibodyPlant(0.0)
drake.Parser(p).AddModelsFromString('<mujoco model="m"><compiler angle="radian"/><default><default class="k"><joint axis="1 0 0"/><default class="p"/></default></default><worldbody><body name="a" pos="0.1 0.2 0.3" ><joint damping="0" stiffness="0" frictionloss="0" armature="0" type="hinge" axis="0 0 1"/><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4"/><body name="b" pos="0 0 0.5" childclass="k"><joint class="p"/><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4"/></body></body></worldbody></mujoco>', 'xml')
p.Finalize()
links = [p.GetBodyByName(name) for name in ['a', 'b']]
c = p.CreateDefaultContext()
q = np.array([0.0, 0.0])
v = np.array([0.0, 0.0])
p.SetPositions(c, q)
p.SetVelocities(c, v)
forces = drake.MultibodyForces(p)
p.CalcForceElementsContribution(c, forces)
value = p.CalcInverseDynamics(c, 0 * v, forces)
import numpy as np
value, expected = np.reshape(value, (2,))[(1,)], 0.9810000000000001
assert abs(value - expected) <= 9.3e-12, f"{value = }, {expected = }"
