"""drake 1.51.1: CalcGravityGeneralizedForces, mjcf: two joints of a body.

Result: g (nv): gravity forces.
Known: none found.
"""

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
p = MultibodyPlant(0.0)
from pydrake.multibody.parsing import Parser
TEXT = '<mujoco model="r"><compiler angle="radian"/><worldbody><body name="a" pos="0.1 0.2 0.3"><joint axis="0.6 0 0.8"/><inertial pos="0.1 -0.2 0.3" mass="2" diaginertia="0.2 0.3 0.4"/><body name="b" pos="0 0 0.5"><joint axis="0 1 0"/><joint type="slide" axis="1 0 0"/><inertial pos="0 0.1 0.2" mass="1" diaginertia="0.2 0.3 0.4"/></body></body></worldbody></mujoco>'
p.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -9.81])
Parser(p).AddModelsFromString(TEXT, 'xml')
p.Finalize()
c = p.CreateDefaultContext()
W = p.world_frame()
def state(q, v=None):
    p.SetPositions(c, q)
    p.SetVelocities(c, np.zeros(p.num_velocities()) if v is None else v)
links = [p.GetBodyByName(name) for name in ['a', 'b']]
q = np.array([-1.0996201868492035, -1.8914015371177906, -0.1816631824515902])
state(q)
value = -p.CalcGravityGeneralizedForces(c)
value = np.array(value, dtype=float)
expected = np.array([1.6360777759340188, 0.43939311407212484, 6.669585613497704])
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 7.3e-12
