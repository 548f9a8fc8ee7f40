"""A closed loop: a four-bar linkage is assembled, asked for the forces in its pins, and let go."""

import numpy as np
from symofros.reference_models import MODELS

import symofros as sf

linkage = MODELS["four_bar"]
model = sf.compile(linkage)
print(f"{model.nv} speeds, {model.nc} conditions of the closure")

state = sf.assemble(model, [1.2, -1.0, 1.3], held=["q1"])
print("assembled at", state.q, "closure error", np.abs(model.constraint(state.q)).max())

a, lam = model.forward_dynamics(state.q, state.v, [], multipliers=True)
pin = linkage.constraints[0].name
print(f"force in the pin '{pin}' [N]", model.closure_wrench(pin, state.q, lam)[:3])
hold = sf.actuator_efforts(model, state.q, np.zeros(3), np.zeros(3), ["q1"])
print("torque on the crank that holds it still [N m]", hold.efforts)

run = sf.simulate(model, state.q, state.v, t_end=0.5, dt=1e-3)
drift = np.abs(model.constraint(run.q)).max()
energy = np.ptp(run.energy) / np.abs(run.energy).max()
print(f"after half a second: {run.outcome}; closure error {drift:.1e} m, energy kept to {energy:.1e}")
