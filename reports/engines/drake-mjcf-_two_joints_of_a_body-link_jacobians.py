# drake 1.51.1, mjcf: two joints of a body: CalcJacobianSpatialVelocity is wrong (Jacobians of the links).
import numpy as np, pydrake.all as drake
p = drake.MultibodyPlant(0.0)
drake.Parser(p).AddModelsFromString("""<mujoco model="r"><compiler angle="radian"/><worldbody><body name="a">
<joint axis="0.6 0 0.8"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><body name="b" pos="0 0 0.5">
<joint axis="0 1 0"/><joint type="slide" axis="1 0 0"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body>
</body></worldbody></mujoco>""", 'xml')
p.Finalize()
links = [p.GetBodyByName(name) for name in ['a', 'b']]
c = p.CreateDefaultContext()
W, kV = p.world_frame(), drake.JacobianWrtVariable.kV
frames = [b.body_frame() for b in links]
value, expected = np.roll(p.CalcJacobianSpatialVelocity(c, kV, frames[1], np.zeros(3), W, W), 3, axis=0)[0, 1], 0.0
assert abs(value - expected) <= 1.3e-12, f'value = {value!r}, expected = {expected!r}'
