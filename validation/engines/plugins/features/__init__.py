"""What engines make of single features, such as elements, drives, trajectories: each text makes a model of its own."""

# What engines call what they are asked about, of `tree.FEATURES`.
DRAKE = {
    "force elements": "LinearBushingRollPitchYaw, DoorHinge, Propeller, Wing",
    "inertias of solids, meshes and convex hulls": "SpatialInertia, CalcSpatialInertia",
    "defaults and parameters: gears, rotors, dampers, model instances": "set_default_gear_ratio, SetMass",
    "joints that are locked, held and coupled in a step": "Joint.Lock, AddDistanceConstraint, AddCouplerConstraint",
    "trajectories": "PiecewisePolynomial, BsplineTrajectory, PiecewisePose",
    "linear systems and controllers": "Simulator, Linearize, LinearQuadraticRegulator",
}
NEWTON = {"defaults and parameters: gears, rotors, dampers, model instances": "ModelBuilder"}
DART = {
    "defaults and parameters: gears, rotors, dampers, model instances": "setInitialPositions, setMass, setCommands",
    "servos, motors, dry friction and joints at limits": "setActuatorType, setCoulombFriction, setLimitEnforcement",
}
