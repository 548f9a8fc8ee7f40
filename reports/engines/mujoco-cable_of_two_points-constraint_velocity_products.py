"""mujoco 4.0.0: -efc_aref, cable of two points.

Result: J' v (m).
Known: none found.
"""

import numpy as np
import mujoco as mj
m = mj.MjModel.from_xml_string('''<mujoco model="tree"><compiler angle="radian"/><option gravity="0.0 0.0 -9.81"/><worldbody>
<body name="a2" pos="-0.22389313947252976 0.018366716325271093 -0.15330021799387417" xyaxes="-0.5308516000564838 -0.17318412954763407 -0.8295805180874846 -0.788742258171837 -0.2570787861380872 0.5583870950261645"><inertial pos="0.0 0.0 0.0" mass="1.0" fullinertia="1.0 1.0 1.0 0.0 0.0 0.0"/><joint type="hinge" axis="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/><site name="s0_0" pos="0.19996768456072295 0.21779463255618675 0.241091802967566" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/></body>
<body name="b1" pos="-0.01707342949160917 -0.06529283638521832 0.4802180483554319" xyaxes="-0.5539275349024826 0.6938688712839012 -0.4601198491046254 -0.046432441517884844 -0.5775396567645017 -0.8150410868410436"><inertial pos="0.0 0.0 0.0" mass="1.0" fullinertia="1.0 1.0 1.0 0.0 0.0 0.0"/><joint type="hinge" axis="0.6666666666666666 -0.3333333333333333 0.6666666666666666"/><site name="s0_1" pos="-0.2594858585227359 -0.21793086860517175 0.02515540797039245" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"/></body>
</worldbody><tendon><spatial name="t0"><site site="s0_0"/><site site="s0_1"/></spatial></tendon><equality><tendon tendon1="t0" solimp="0.9999 0.9999 0.001"/></equality></mujoco>''')
d = mj.MjData(m)
def axes(): return block_diag(np.eye(1))
def block_diag(*parts):
    n, at = sum(map(len, parts)), 0
    R = np.zeros((n, n))
    for part in parts:
        R[at:at + len(part), at:at + len(part)], at = part, at + len(part)
    return R
q = np.array([-0.6642498116212777, 1.03253423618331])
v = np.array([0.3187232918959925, -0.20121176787956796])
tau = np.array([0.0, 0.0])
m.eq_solref[:] = 0.0
m.opt.jacobian, m.opt.tolerance = mj.mjtJacobian.mjJAC_DENSE, 0.0
d.qpos[:], d.qvel[:], d.qfrc_applied[:] = q, v, tau
mj.mj_forward(m, d)
value = -axes() @ d.efc_aref
value = np.array(value, dtype=float)
expected = np.array([-0.020526253152789022])
error = np.max(np.abs(value - expected))
print(f"{value = }\n{expected = }\n{error = :.3g}")
assert error <= 4.2e-14
