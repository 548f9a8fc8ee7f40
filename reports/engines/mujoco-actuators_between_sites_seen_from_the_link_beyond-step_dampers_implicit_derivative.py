# mujoco 4.0.0, actuators between sites, seen from the link beyond: mjd_transitionFD is wrong (derivative of q+, v+ of that step by q, v along speeds (2 nv, 2 nv)).
import numpy as np
import mujoco as mj
m = mj.MjModel.from_xml_string('''<mujoco model="tree"><compiler angle="radian"/><option gravity="0.0 0.0 0.0"/><worldbody>
<body name="a" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="-0.19363549925678827 0.17992215962247687 0.15707617325004608" mass="1.2563911747131722" diaginertia="0.07879440491625532 0.10542779965857761 0.1428972946967548" xyaxes="0.6682640434895628 -0.32771536725241845 -0.6678516349052327 0.5205182987770598 -0.43540671647722407 0.7344941741666554"/><joint type="hinge" axis="0.0 0.0 1.0" damping="0.75"/><site name="u0_0" pos="-0.2462137928591217 0.15692586496629352 -0.02418158792402686" xyaxes="-0.36861653824808815 -0.864556215368734 -0.34156170481669496 -0.28972244170186684 -0.24228400676107698 0.9259370209912263"/><body name="c" pos="0.0 0.0 0.0" xyaxes="1.0 0.0 0.0 0.0 1.0 0.0"><inertial pos="-0.14129166278090316 -0.15153591764389374 -0.12482394563973753" mass="0.8934710999773726" diaginertia="0.09132244073059369 0.12069347933356742 0.16903778247163131" xyaxes="-0.5580275949113387 0.5503039600999753 -0.6211044636900878 -0.8034688269953 -0.1711773953721285 0.5702071056733775"/><joint type="hinge" axis="0.0 0.0 1.0" stiffness="3.0" springref="0.25"/><site name="u0_1" pos="0.2498098376334898 0.25684530691179447 -0.03808741457630349" xyaxes="-0.3964192512878423 -0.6622583537592845 0.6358188815098439 0.9129207611868112 -0.21111181823674013 0.34929569707465746"/></body></body>
</worldbody><actuator><general gainprm="0.5" biastype="affine" biasprm="0.25 -1.0 -0.75" site="u0_0" refsite="u0_1" gear="1.0 -2.0 1.5 0.0 0.0 0.0" ctrllimited="true" ctrlrange="-1.0 1.0"/></actuator></mujoco>''')
d = mj.MjData(m)
d.ctrl[:] = [2.0]
bs = [m.body(name).id for name in ['a', 'c']]
q = np.array([-1.0996201868492035, -0.45415795612897547])
v = np.array([0.0, 0.0])
tau = np.array([0.0, 0.0])
from copy import copy
n = copy(m)
n.opt.timestep = 0.015625
d.qfrc_applied[:] = tau
d.qpos[:], d.qvel[:] = q, v
mj.mj_forward(m, d)
A = np.zeros([2 * m.nv + m.na] * 2)
mj.mjd_transitionFD(n, d, 1e-6, True, A, None, None, None)
A = A[:2 * m.nv, :2 * m.nv]
value = A
import numpy as np
value, expected = np.reshape(value, (4, 4))[(3, 3)], 0.9963763808723475
assert abs(value - expected) <= 1.5e-06, f"{value = }, {expected = }"
