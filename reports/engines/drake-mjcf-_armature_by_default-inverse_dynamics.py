"""drake 1.51.1: CalcInverseDynamics, mjcf: armature by default.

Result: M a + h (nv).
Known: https://github.com/RobotLocomotion/drake/pull/21967.
"""

import numpy as np
from pydrake.multibody import tree
from pydrake.multibody.plant import MultibodyPlant
p = MultibodyPlant(0.0)
from pydrake.multibody.parsing import Parser
TEXT = '<mujoco model="r"><compiler angle="radian"/><default><joint armature="0.5"/></default><worldbody><body name="a" pos="0.1 0.2 0.3"><joint axis="0.6 0 0.8"/><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4"/><body name="b" pos="0 0 0.5"><joint axis="0 1 0"/><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4"/></body></body></worldbody></mujoco>'
p.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -9.81])
Parser(p).AddModelsFromString(TEXT, 'xml')
p.Finalize()
c = p.CreateDefaultContext()
W = p.world_frame()
def state(q, v=None):
    p.SetPositions(c, q)
    p.SetVelocities(c, np.zeros(p.num_velocities()) if v is None else v)
def forces():
    applied = tree.MultibodyForces(p)
    p.CalcForceElementsContribution(c, applied)
    return applied
links = [p.GetBodyByName(name) for name in ['a', 'b']]
q = np.array([-1.0996201868492035, -1.8914015371177906])
v = np.array([-0.1816631824515902, -0.8567209055906702])
a = np.array([-0.8020666483629364, 0.9725767279334938])
state(q, v)
value = p.CalcInverseDynamics(c, a, forces())
value = np.array(value, dtype=float)
expected = np.array([1.2599208616791726, 2.138549534469609])
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 2.8e-12
