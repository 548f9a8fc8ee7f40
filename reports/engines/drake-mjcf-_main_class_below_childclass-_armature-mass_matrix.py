# drake 1.51.1, mjcf: main class below childclass: armature: CalcMassMatrix is wrong (M).
# Known: https://github.com/RobotLocomotion/drake/pull/21967.
import numpy as np
import pydrake.all as drake
p = drake.MultibodyPlant(0.0)
drake.Parser(p).AddModelsFromString('<mujoco model="m"><compiler angle="radian"/><default><joint armature="0.5"/><default class="k"/></default><worldbody><body name="a" pos="0.1 0.2 0.3" ><joint damping="0" stiffness="0" frictionloss="0" armature="0" type="hinge" axis="0 0 1"/><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4"/><body name="b" pos="0 0 0.5" childclass="k"><joint axis="0 1 0" class="main"/><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4"/></body></body></worldbody></mujoco>', 'xml')
p.Finalize()
links = [p.GetBodyByName(name) for name in ['a', 'b']]
c = p.CreateDefaultContext()
q = np.array([0.0, 0.0])
p.SetPositions(c, q)
value = p.CalcMassMatrix(c)
import numpy as np
value, expected = np.reshape(value, (2, 2))[(1, 1)], 0.84
assert abs(value - expected) <= 1.1e-12, f"{value = }, {expected = }"
