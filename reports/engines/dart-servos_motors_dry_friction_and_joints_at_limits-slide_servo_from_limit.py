# dart 6.20.0, servos, motors, dry friction and joints at limits: setCommand of a SERVO at a limit, step is wrong (coordinate and speed after a step at its limit, at rest, that a load presses against it and a servo drives away).
# Known: https://github.com/dartsim/dart/issues/2422.
import numpy as np
import dartpy as dart
v = np.array([0.0, 0.0, 0.0])
world, s = dart.simulation.World(), dart.dynamics.Skeleton('s')
world.setTimeStep(0.015625)
world.setGravity(np.array([9.0, 0.0, 0.0]))
j, b = s.createPrismaticJointAndBodyNodePair(None)
j.setAxis([1.0, 0.0, 0.0])
b.setInertia(dart.dynamics.Inertia(2.0, np.zeros(3), np.eye(3)))
world.addSkeleton(s)
j.setActuatorType(dart.dynamics.ActuatorType.SERVO)
j.setForceLowerLimit(0, -1000000000.0)
j.setForceUpperLimit(0, 1000000000.0)
j.setPositionUpperLimit(0, 0.5)
j.setPositionLowerLimit(0, -9.0)
j.setLimitEnforcement(True)
j.setPosition(0, 0.5)
for _ in range(8): j.setCommand(0, 1.0); world.step()
j.setCommand(0, -abs(v[0]) - 1)
world.step()
value = [j.getPosition(0), j.getVelocity(0)]
import numpy as np
value, expected = np.reshape(value, (2,))[(1,)], -1.0
assert abs(value - expected) <= 1.0e-08, f"{value = }, {expected = }"
