# newton 1.8.0, usd: metres left out: body_mass, body_com, body_inertia is wrong (mass, mass times mass centre, moments about it xx, yy, zz, xy, xz, yz along the link's axes).
# Known: https://github.com/newton-physics/newton/pull/3219 (warns where another unit is stated).
import numpy as np, warp as wp
wp.config.quiet, wp.config.log_level = True, 30
wp.config.enable_backward, wp.config.optimization_level = False, 0
import newton
TEXT = '#usda 1.0\n(\n    defaultPrim = "m"\n    kilogramsPerUnit = 1\n    upAxis = "Z"\n)\ndef PhysicsScene "scene" {\n    vector3f physics:gravityDirection = (0, 0, -1)\n    float physics:gravityMagnitude = 981\n}\ndef Xform "m" (prepend apiSchemas = ["PhysicsArticulationRootAPI"]) {\n    def Xform "b" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]) {\n        double3 xformOp:translate = (0, 0, 50)\n        uniform token[] xformOpOrder = ["xformOp:translate"]\n        float physics:mass = 1\n        point3f physics:centerOfMass = (0, 12.5, 25)\n        float3 physics:diagonalInertia = (2500, 3750, 5000)\n        quatf physics:principalAxes = (1, 0, 0, 0)\n    }\n    def PhysicsRevoluteJoint "joint" {\n        rel physics:body1 = </m/b>\n        point3f physics:localPos0 = (0, 0, 50)\n        uniform token physics:axis = "Y"\n    }\n}\n'
b = newton.ModelBuilder()
newton.solvers.SolverMuJoCo.register_custom_attributes(b)
from pxr import Usd
stage = Usd.Stage.CreateInMemory()
stage.GetRootLayer().ImportFromString(TEXT)
b.add_usd(stage, apply_up_axis_from_stage=True)
b.articulation_count or b.add_articulation(list(range(b.joint_count)))
m = b.finalize(device="cpu")
def rotation(x, y, z, w):
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * K + 2 * K @ K
bodies = [[x.split('/')[-1] for x in m.body_label].index(name) for name in ['b']]
value = [[mass, *(mass * com), *I[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]] for mass, com, I in zip(
    m.body_mass.numpy()[bodies], m.body_com.numpy()[bodies], m.body_inertia.numpy()[bodies])]
import numpy as np
value, expected = np.reshape(value, (1, 10))[(0, 6)], 0.5
assert abs(value - expected) <= 7.8e-04, f"{value = }, {expected = }"
