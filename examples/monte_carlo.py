"""Monte Carlo: a pendulum on a cart, released 2000 times with random masses and lengths; the batch runs in C."""

import numpy as np
from symofros.reference_models import MODELS

import symofros as sf

model = sf.compile(MODELS["cart_pole"])
print("parameters", model.parameters)

rng = np.random.default_rng(0)
runs = 2000
spread = 1.0 + 0.1 * rng.standard_normal((runs, model.npar))
starts = np.tile([0.0, 0.2], (runs, 1))
law = {"F": "30*q + 6*dq + 1*x + 2*dx"}  # one law for all of them

par = model.parameter_values * spread
motions = sf.simulate_batch(model, starts, t_end=2.0, dt=1e-3, par=par, u=law, output=0.1, threads=2)
last = motions.q[:, -1]
print(motions)
print(f"{motions.ok.sum()} of {runs} came to their end")
for k, name in enumerate(model.names.q):
    low, middle, high = np.percentile(last[:, k], [5, 50, 95])
    print(f"{name} after 2 s: median {middle:.3f}, 5 % to 95 %: {low:.3f} to {high:.3f}")
