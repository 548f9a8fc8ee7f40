"""Drake's numbers that are set late or in a context, models of several instances, joints that are held in steps."""

from __future__ import annotations

from ...interface import STEP
from ...truth.features.parameters import COUPLED, DAMPING, GRAVITY, MASSES, REST, STIFFNESS
from ..loops.drake_forces import SAP
from ..writing.source import NO_SOLUTION, Way, ways_of

_X = "x = np.abs(v) + 0.5\n"
_UNIT = "drake.SpatialInertia(1.0, np.zeros(3), drake.UnitInertia(1.0, 1.0, 1.0))"
_GEARED = f"""{_X}p = drake.MultibodyPlant(0.0)
b = p.AddRigidBody('b', {_UNIT})
j = p.AddJoint(drake.RevoluteJoint('j', p.world_frame(), b.body_frame(), [0, 0, 1]))
motor = p.AddJointActuator('motor', j)
"""
_DEFAULTS = "motor.set_default_rotor_inertia(x[0])\nmotor.set_default_gear_ratio(x[1])\n"
_OTHERS = "motor.set_default_rotor_inertia(0.25)\nmotor.set_default_gear_ratio(3.0)\n"
_DONE, _CONTEXT = "p.Finalize()\n", "c = p.CreateDefaultContext()\n"
_SET = "motor.SetRotorInertia(c, x[0])\nmotor.SetGearRatio(c, x[1])\n"
_M = "value = p.CalcMassMatrix(c)[0]"
_BY_GEAR = {
    "": ("set_default_gear_ratio", f"{_GEARED}{_DEFAULTS}{_DONE}{_CONTEXT}"),
    ":after Finalize": ("set_default_gear_ratio after Finalize", f"{_GEARED}{_DONE}{_DEFAULTS}{_CONTEXT}"),
    ":again after Finalize": (
        "set_default_rotor_inertia after Finalize",
        f"{_GEARED}{_OTHERS}{_DONE}c = p.CreateDefaultContext()\n{_DEFAULTS}{_CONTEXT}",
    ),
    ":context": ("SetGearRatio, SetRotorInertia", f"{_GEARED}{_OTHERS}{_DONE}{_CONTEXT}{_SET}"),
    ":copied context": ("SetGearRatio, Context.Clone", f"{_GEARED}{_OTHERS}{_DONE}{_CONTEXT}{_SET}c = c.Clone()\n"),
    ":Clone": ("set_default_gear_ratio after Finalize, Clone", f"{_GEARED}{_DONE}{_DEFAULTS}p = p.Clone()\n{_CONTEXT}"),
    ":SetDefaultContext": (
        "SetDefaultContext",
        f"{_GEARED}{_DONE}{_DEFAULTS}{_CONTEXT}motor.SetGearRatio(c, 7.0)\np.SetDefaultContext(c)\n",
    ),
}
_SCALARS = {
    ":AutoDiffXd": ("ToAutoDiffXd", "value = [x.value() for x in p.ToAutoDiffXd().CalcMassMatrix(d)[0]]"),
    ":symbolic": ("ToSymbolic", "value = [x.Evaluate() for x in p.ToSymbolic().CalcMassMatrix(d)[0]]"),
}
WAYS = {f"mass_with_rotor{way}": Way(name, text + _M) for way, (name, text) in _BY_GEAR.items()}
WAYS |= {
    f"mass_with_rotor{way}": Way(
        f"set_default_gear_ratio after Finalize, {name}",
        f"{_GEARED}{_DONE}{_DEFAULTS}ad = p.{name}()\nd = ad.CreateDefaultContext()\n"
        + code.replace(f"p.{name}()", "ad"),
    )
    for way, (name, code) in _SCALARS.items()
}
WAYS |= {
    f"acceleration_with_rotor{way}": Way(
        f"EvalTimeDerivatives, {name}",
        f"{text}p.get_actuation_input_port().FixValue(c, tau[:1])\nvalue = p.EvalTimeDerivatives(c).CopyToVector()[1:]",
    )
    for way, (name, text) in _BY_GEAR.items()
}
WAYS |= ways_of(f"""
== rotor_and_gear | rotor_inertia, gear_ratio, calc_reflected_inertia
{_BY_GEAR[":context"][1]}value = [motor.rotor_inertia(c), motor.gear_ratio(c), motor.calc_reflected_inertia(c)]
== rotor_and_gear:default | default_rotor_inertia, default_gear_ratio, default_reflected_inertia
{_BY_GEAR[":after Finalize"][1]}value = [motor.default_rotor_inertia(), motor.default_gear_ratio(), \
motor.default_reflected_inertia()]
""")

# Bodies of the two models are made in turns.
_SLIDES = f"""p = drake.MultibodyPlant(TIME)
p.mutable_gravity_field().set_gravity_vector({list(GRAVITY)})
one, two = p.AddModelInstance('one'), p.AddModelInstance('two')
def slide(name, model, mass, axis, parent):
    b = p.AddRigidBody(name, model, drake.SpatialInertia(mass, np.zeros(3), drake.UnitInertia(1.0, 1.0, 1.0)))
    return p.AddJoint(drake.PrismaticJoint(name, parent, b.body_frame(), axis)), b
(jx, bx), (jz, bz) = slide('x', one, {MASSES[0]}, [1, 0, 0], W), slide('z', two, {MASSES[2]}, [0, 0, 1], W)
jy, by = slide('y', one, {MASSES[1]}, [0, 1, 0], bx.body_frame())
jj = (jx, jy, jz)
""".replace("W)", "p.world_frame())")
_MOTORS = "my, mz, mx = (p.AddJointActuator('m' + j.name(), j) for j in (jy, jz, jx))\n"
_STATE = "for j, q, u in zip(jj, v, a): j.set_translation(c, q); j.set_translation_rate(c, u)\n"
_PLACES = "qs, vs = ([getattr(j, name)() for j in jj] for name in ('position_start', 'velocity_start'))\n"
_PLANT = _SLIDES.replace("TIME", "0.0")
_MADE = f"{_PLANT}{_DONE}{_CONTEXT}{_PLACES}"
_FORCED = "f = np.zeros(3)\nf[vs] = tau\np.get_applied_generalized_force_input_port().FixValue(c, f)\n"
_ACCELERATION = "value = p.EvalTimeDerivatives(c).CopyToVector()[3:][vs]"
_BY_INSTANCE = "np.r_[p.GetPositions(c, one), p.GetPositions(c, two)]"
_FORCES = "f = drake.MultibodyForces(p)\n"
_LIMITS = """for j, y in zip(jj, x):
    j.set_position_limits([-y], [2 * y]); j.set_velocity_limits([-3 * y], [4 * y])
    j.set_acceleration_limits([-5 * y], [6 * y])
"""
_TOLD = (
    "value = [getattr(p, f'Get{of}{end}Limits')()[vs] for of in ('Position', 'Velocity', 'Acceleration')"
    " for end in ('Lower', 'Upper')]"
)
_INERTIA = "drake.SpatialInertia(y, np.zeros(3), drake.UnitInertia(1.0, 1.0, 1.0))"
WAYS |= ways_of(f"""
== coordinates_set | PrismaticJoint.set_translation | {_MADE}{_STATE}value = p.GetPositions(c)[qs]
== coordinates_set:instances | SetPositions of a model instance
{_MADE}p.SetPositions(c, two, v[2:])
p.SetPositions(c, one, v[:2])
value = {_BY_INSTANCE}
== coordinates_set:array | SetPositionsInArray
{_MADE}x = np.zeros(3)
x[qs] = 7.0
p.SetPositionsInArray(one, v[:2], x)
p.SetPositionsInArray(two, v[2:], x)
p.SetPositions(c, x)
value = {_BY_INSTANCE}
== coordinates_set:default | PrismaticJoint.set_default_translation after Finalize
{_MADE}for j, y in zip(jj, v): j.set_default_translation(y)
{_CONTEXT}value = {_BY_INSTANCE}
== coordinates_set:default before Finalize | PrismaticJoint.set_default_translation
{_PLANT}for j, y in zip(jj, v): j.set_default_translation(y)
{_DONE}{_CONTEXT}value = {_BY_INSTANCE}
== coordinates_set:default of instances | SetDefaultPositions of a model instance
{_MADE}p.SetDefaultPositions(two, v[2:])
p.SetDefaultPositions(one, v[:2])
{_CONTEXT}value = {_BY_INSTANCE}
== coordinates_set:default positions | Joint.set_default_positions, SetDefaultContext
{_MADE}for j, y in zip(jj, v): j.set_default_positions([y])
p.SetDefaultContext(c)
value = {_BY_INSTANCE}
== coordinates_set:Clone | SetDefaultPositions, Clone
{_MADE}p.SetDefaultPositions(two, v[2:])
p.SetDefaultPositions(one, v[:2])
p = p.Clone()
{_CONTEXT}value = {_BY_INSTANCE}
""") | ways_of(f"""
== coordinates_set:GetDefaultPositions | GetDefaultPositions
{_MADE}p.SetDefaultPositions(two, v[2:])
p.SetDefaultPositions(one, v[:2])
value = np.r_[p.GetDefaultPositions(one), p.GetDefaultPositions(two)]
== speeds_set | SetVelocities of a model instance
{_MADE}p.SetVelocities(c, two, a[2:])
p.SetVelocities(c, one, a[:2])
value = [j.get_translation_rate(c) for j in jj]
== speeds_set:array | SetVelocitiesInArray
{_MADE}x = np.zeros(3)
p.SetVelocitiesInArray(one, a[:2], x)
p.SetVelocitiesInArray(two, a[2:], x)
p.SetVelocities(c, x)
value = p.GetVelocities(c)[vs]
== speeds_set:GetVelocitiesFromArray | GetVelocitiesFromArray
{_MADE}{_STATE}x = p.GetVelocities(c)
value = np.r_[p.GetVelocitiesFromArray(one, x), p.GetVelocitiesFromArray(two, x)]
== coordinates_set:GetPositionsFromArray | GetPositionsFromArray
{_MADE}{_STATE}x = p.GetPositions(c)
value = np.r_[p.GetPositionsFromArray(one, x), p.GetPositionsFromArray(two, x)]
== states_of_models | GetPositionsAndVelocities of a model instance
{_MADE}{_STATE}value = np.r_[p.GetPositionsAndVelocities(c, one), p.GetPositionsAndVelocities(c, two)]
== states_of_models:SetPositionsAndVelocities | SetPositionsAndVelocities of a model instance
{_MADE}p.SetPositionsAndVelocities(c, two, [v[2], a[2]])
p.SetPositionsAndVelocities(c, one, [*v[:2], *a[:2]])
x = np.c_[[j.get_translation(c) for j in jj], [j.get_translation_rate(c) for j in jj]]
value = [*x[:2, 0], *x[:2, 1], *x[2]]
== states_of_models:port | get_state_output_port of a model instance
{_MADE}{_STATE}value = np.r_[p.get_state_output_port(one).Eval(c), p.get_state_output_port(two).Eval(c)]
== states_of_models:MakeStateSelectorMatrix | MakeStateSelectorMatrix
{_MADE}{_STATE}x = p.MakeStateSelectorMatrix([j.index() for j in jj]) @ p.GetPositionsAndVelocities(c)
value = [x[0], x[1], x[3], x[4], x[2], x[5]]
== sums_of_models | CalcTotalMass, CalcCenterOfMassPositionInWorld of model instances
{_MADE}{_STATE}of = p.CalcCenterOfMassPositionInWorld
value = np.r_[p.CalcTotalMass(c), p.CalcTotalMass(c, [one]), p.CalcTotalMass(c, [two]), of(c), of(c, [one]), of(c, \
[two]), p.CalcCenterOfMassTranslationalVelocityInWorld(c, [one])]
== momenta_of_models | CalcSpatialMomentumInWorldAboutPoint of model instances
{_MADE}{_STATE}L = p.CalcSpatialMomentumInWorldAboutPoint(c, [one], tau)
value = [*L.translational(), *L.rotational()]
== accelerations_forced | applied_generalized_force input port | {_MADE}{_FORCED}{_ACCELERATION}
== accelerations_forced:AddInOneForce | Joint.AddInOneForce
{_MADE}{_FORCES}for j, y in zip(jj, tau): j.AddInOneForce(c, 0, y, f)
p.CalcForceElementsContribution(c, g := drake.MultibodyForces(p))
f.AddInForces(g)
value = np.linalg.solve(p.CalcMassMatrix(c), -p.CalcInverseDynamics(c, np.zeros(3), f))[vs]
== accelerations_forced:actuation | get_actuation_input_port of a model instance
{_PLANT}{_MOTORS}{_DONE}{_CONTEXT}{_PLACES}x = np.zeros(3)
x[[m.input_start() for m in (mx, my, mz)]] = tau
for i in (one, two): p.get_actuation_input_port(i).FixValue(c, p.GetActuationFromArray(i, x))
{_ACCELERATION}
== accelerations_forced:SetActuationInArray | SetActuationInArray, MakeActuationMatrix
{_PLANT}{_MOTORS}{_DONE}{_CONTEXT}{_PLACES}x = np.zeros(3)
p.SetActuationInArray(two, tau[2:], x)
p.SetActuationInArray(one, tau[1::-1], x)
p.get_applied_generalized_force_input_port().FixValue(c, p.MakeActuationMatrix() @ x)
{_ACCELERATION}
== accelerations_forced:MakeActuatorSelectorMatrix | MakeActuatorSelectorMatrix
{_PLANT}{_MOTORS}{_DONE}{_CONTEXT}{_PLACES}x = p.MakeActuatorSelectorMatrix([m.index() for m in (mx, my, mz)]) @ tau
p.get_actuation_input_port().FixValue(c, x)
{_ACCELERATION}
== accelerations_forced:set_actuation_vector | JointActuator.set_actuation_vector
{_PLANT}{_MOTORS}{_DONE}{_CONTEXT}{_PLACES}x = np.zeros(3)
for m, y in zip((mx, my, mz), tau): m.set_actuation_vector([y], x)
p.get_actuation_input_port().FixValue(c, x)
{_ACCELERATION}
== masses_set | RigidBody.SetMass
{_X}{_MADE}for b, y in zip((bx, by, bz), x): b.SetMass(c, y)
value = p.CalcMassMatrix(c)[np.ix_(vs, vs)]
== masses_set:SetSpatialInertiaInBodyFrame | RigidBody.SetSpatialInertiaInBodyFrame
{_X}{_MADE}for b, y in zip((bx, by, bz), x): b.SetSpatialInertiaInBodyFrame(c, {_INERTIA})
value = p.CalcMassMatrix(c)[np.ix_(vs, vs)]
== masses_set:AutoDiffXd | RigidBody.SetMass, ToAutoDiffXd
{_X}{_MADE}for b, y in zip((bx, by, bz), x): b.SetMass(c, y)
ad = p.ToAutoDiffXd()
d = ad.CreateDefaultContext()
d.SetTimeStateAndParametersFrom(c)
value = np.array([[y.value() for y in row] for row in ad.CalcMassMatrix(d)])[np.ix_(vs, vs)]
== damping_set | PrismaticJoint.SetDamping, AddInDamping
{_X}{_MADE}{_STATE}for j, y in zip(jj, x): j.SetDamping(c, y)
{_FORCES}for j in jj: j.AddInDamping(c, f)
value = f.generalized_forces()[vs]
== limits_set | Joint.set_position_limits, set_velocity_limits, set_acceleration_limits
{_X}{_PLANT}{_LIMITS}{_DONE}{_CONTEXT}{_PLACES}{_TOLD}
== limits_set:after Finalize | Joint.set_position_limits after Finalize | {_X}{_MADE}{_LIMITS}{_TOLD}
== limits_set:Clone | Joint.set_position_limits, Clone | {_X}{_PLANT}{_LIMITS}{_DONE}{_PLACES}p = p.Clone()\n{_TOLD}
== limits_set:joint | Joint.position_lower_limits, velocity_upper_limits, acceleration_lower_limits
{_X}{_MADE}{_LIMITS}value = [[getattr(j, f'{{of}}_{{end}}_limits')()[0] for j in jj] for of in ('position', \
'velocity', 'acceleration') for end in ('lower', 'upper')]
== accelerations_forced:MakeActuationMatrixPseudoinverse | MakeActuationMatrixPseudoinverse
{_PLANT}{_MOTORS}{_DONE}{_CONTEXT}{_PLACES}f = np.zeros(3)
f[vs] = tau
p.get_actuation_input_port().FixValue(c, p.MakeActuationMatrixPseudoinverse() @ f)
{_ACCELERATION}
== power_of_damping | CalcNonConservativePower
{_X}{_MADE}{_STATE}for j, y in zip(jj, x): j.SetDamping(c, y)
value = [p.CalcNonConservativePower(c)]
== damping_set:SetDampingVector | Joint.SetDampingVector
{_X}{_MADE}{_STATE}for j, y in zip(jj, x): j.SetDampingVector(c, [y])
{_FORCES}p.CalcForceElementsContribution(c, f)
g = p.CalcGravityGeneralizedForces(c)
value = (-p.CalcInverseDynamics(c, np.zeros(3), f) - g)[vs]
== damping_set:default | PrismaticJoint.set_default_damping
{_X}{_PLANT}for j, y in zip(jj, x): j.set_default_damping(y)
{_DONE}{_CONTEXT}{_PLACES}{_STATE}{_FORCES}p.CalcForceElementsContribution(c, f)
g = p.CalcGravityGeneralizedForces(c)
value = (-p.CalcInverseDynamics(c, np.zeros(3), f) - g)[vs]
""")
_SPRING = f"""{_X}p = drake.MultibodyPlant(0.0)
p.mutable_gravity_field().set_gravity_vector([0.0, 0.0, 0.0])
b = p.AddRigidBody('b', {_UNIT})
j = p.AddJoint(drake.KINDJoint('j', p.world_frame(), b.body_frame(), [0, 0, 1]))
k = p.AddForceElement(drake.KINDSpring(j, REST, STIFFNESS))
{_DONE}{_CONTEXT}p.SetPositions(c, v[2:])
"""
_FORCE_OF_SPRING = (
    f"{_FORCES}p.CalcForceElementsContribution(c, f)\n"
    "value = [-p.CalcInverseDynamics(c, np.zeros(1), f)[0], p.CalcPotentialEnergy(c)]"
)


def _spring(kind: str, rest: str, stiffness: str) -> str:
    return _SPRING.replace("KIND", kind).replace("REST", rest).replace("STIFFNESS", stiffness)


WAYS |= {
    "spring_set": Way("PrismaticSpring", _spring("Prismatic", "x[1]", "x[0]") + _FORCE_OF_SPRING),
    "spring_set:RevoluteSpring": Way("RevoluteSpring", _spring("Revolute", "x[1]", "x[0]") + _FORCE_OF_SPRING),
    "spring_set:SetStiffness": Way(
        "RevoluteSpring.SetStiffness, SetNominalAngle",
        f"{_spring('Revolute', '7.0', '3.0')}k.SetStiffness(c, x[0])\nk.SetNominalAngle(c, x[1])\n{_FORCE_OF_SPRING}",
    ),
}

# Of a plant with a time step.
_DISCRETE = _SLIDES.replace("TIME", str(STEP)).replace(str(list(GRAVITY)), "[0.0, 0.0, 0.0]")
_SAP = "\n".join(SAP) + "\nsap(p)\n"
_RUN = "sim = drake.Simulator(p)\nc = sim.get_mutable_context()\n"
_STEPPED = f"sim.AdvanceTo({STEP})\n"
_BOTH = "value = [*(j.get_translation(c) for j in jj), *(j.get_translation_rate(c) for j in jj)]"
_LOCK = f"{_DONE}{_RUN}{_PLACES}{_STATE}{_FORCED}"
_BETWEEN = f"p.AddDistanceConstraint(bx, np.zeros(3), bz, np.zeros(3), {REST}, {STIFFNESS}, {DAMPING})"
_ON_X = """jx.set_translation(c, v[2]); jz.set_translation(c, v[2] + abs(v[0]) + 1)
jx.set_translation_rate(c, a[0]); jz.set_translation_rate(c, a[2])
"""
_X_ALONE = f"{_DISCRETE}{_SAP}".replace("jy, by = slide('y', one, 3.0, [0, 1, 0], bx.body_frame())", "jy = jz")
_ONE_LINE = _X_ALONE.replace("[0, 0, 1]", "[1, 0, 0]")
_PUSHED = (
    "f = np.zeros(2)\nf[jx.velocity_start()], f[jz.velocity_start()] = tau[0], tau[2]\n"
    "p.get_applied_generalized_force_input_port().FixValue(c, f)\n"
)
_OF_TWO = "value = [*(j.get_translation(c) for j in (jx, jz)), *(j.get_translation_rate(c) for j in (jx, jz))]"
WAYS |= ways_of(f"""
== step_of_locked | Joint.Lock | {_DISCRETE}{_LOCK}jy.Lock(c)\n{_STEPPED}{_BOTH}
== step_of_locked:sap | Joint.Lock, SAP | {_DISCRETE}{_SAP}{_LOCK}jy.Lock(c)\n{_STEPPED}{_BOTH}
== step_of_unlocked | Joint.Unlock | {_DISCRETE}{_LOCK}jx.Lock(c)\njx.Unlock(c)\n{_STATE}{_STEPPED}{_BOTH}
== step_of_unlocked:RigidBody | RigidBody.Unlock, SAP
{_DISCRETE}{_SAP}{_LOCK}jy.Lock(c)
jy.Unlock(c)
{_STATE}{_STEPPED}{_BOTH}
== step_of_held_distance | AddDistanceConstraint
{_ONE_LINE}{_BETWEEN}
{_DONE}{_RUN}{_ON_X}{_PUSHED}{_STEPPED}{_OF_TWO}
== step_of_held_distance:SetDistanceConstraintParams | SetDistanceConstraintParams
{_ONE_LINE}k = p.AddDistanceConstraint(bx, np.zeros(3), bz, np.zeros(3), 7.0, 5.0, 3.0)
{_DONE}{_RUN}o = p.GetDistanceConstraintParams(c, k)
p.SetDistanceConstraintParams(c, k, drake.DistanceConstraintParams(o.bodyA(), o.p_AP(), o.bodyB(), o.p_BQ(), {REST}, \
{STIFFNESS}, {DAMPING}))
{_ON_X}{_PUSHED}{_STEPPED}{_OF_TWO}
== step_of_freed_distance | SetConstraintActiveStatus
{_ONE_LINE}k = {_BETWEEN}
{_DONE}{_RUN}p.SetConstraintActiveStatus(c, k, False)
{_ON_X}{_PUSHED}{_STEPPED}{_OF_TWO}
== step_of_freed_distance:RemoveConstraint | RemoveConstraint
{_ONE_LINE}k = {_BETWEEN}
p.RemoveConstraint(k)
{_DONE}{_RUN}{_ON_X}{_PUSHED}{_STEPPED}{_OF_TWO}
== goal_of_locked ~ 1e-5 | InverseKinematics, Joint.Lock
{_DISCRETE}{_DONE}{_CONTEXT}{_PLACES}jy.set_translation(c, v[1])
jy.Lock(c)
ik, x = drake.InverseKinematics(p, c), a[0] / (1 + abs(a[0]))
ik.AddPositionConstraint(by.body_frame(), np.zeros(3), p.world_frame(), [x, -np.inf, -np.inf], [x, np.inf, np.inf])
result = drake.Solve(ik.prog(), np.zeros(3))
if not result.is_success(): raise {NO_SOLUTION.replace(": ", "('")}')
value = result.GetSolution(ik.q())[qs][:2]
== # SAP's solver in the near-rigid regime, as for `step_bound`.
== step_of_coupled ~ 0.001 | AddCouplerConstraint
{_X_ALONE}p.AddCouplerConstraint(jx, jz, {COUPLED[0]}, {COUPLED[1]})
{_DONE}{_RUN}jz.set_translation(c, v[2])
jx.set_translation(c, {COUPLED[0]} * v[2] + {COUPLED[1]})
jz.set_translation_rate(c, a[2])
jx.set_translation_rate(c, {COUPLED[0]} * a[2])
{_PUSHED}{_STEPPED}value = [jx.get_translation_rate(c), jz.get_translation_rate(c)]
""")
