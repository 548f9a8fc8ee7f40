# pinocchio 4.1.0, mjcf: armature by default: computeKineticEnergy is wrong (T = v^T M v / 2).
import numpy as np, pinocchio as pin
TEXT = """<mujoco model="r"><compiler angle="radian"/><default><joint armature="0.5"/></default><worldbody>
<body name="a"><joint axis="0.6 0 0.8"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body></worldbody>
</mujoco>"""
import tempfile
file = tempfile.NamedTemporaryFile('w', suffix='.xml')
print(TEXT, file=file, flush=True)
m = pin.buildModelFromMJCF(file.name)
value, expected = pin.computeKineticEnergy(m, m.createData(), np.zeros(1), np.array([1.0])), 0.75
assert abs(value - expected) <= 1.4e-12, f'value = {value!r}, expected = {expected!r}'
