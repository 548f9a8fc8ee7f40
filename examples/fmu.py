"""Export a pendulum as a Functional Mock-up Unit and run it in another simulator, FMPy. Needs the extra `fmi`."""

import tempfile

import fmpy
import numpy as np

import symofros as sf

rod = sf.Inertia(mass="m", center_of_mass=("L/2", 0, 0), moments=(0, "m*L^2/12", "m*L^2/12"))
pendulum = sf.System(
    "pendulum",
    bodies=[sf.RigidBody("rod", sf.Joint("q", "revolute", axis=(0, 1, 0), actuated=True), rod)],
    parameters=[sf.Parameter("m", 1.0, "kg"), sf.Parameter("L", 1.0, "m")],
)

with tempfile.TemporaryDirectory() as folder:
    unit = str(sf.export(pendulum, "fmu2", folder, start={"q": 0.5}).files[0])
    variables = [variable.name for variable in fmpy.read_model_description(unit).modelVariables]
    print(len(variables), "variables, among them", *variables[:8])
    there = fmpy.simulate_fmu(unit, fmi_type="CoSimulation", stop_time=1.0, output_interval=0.1)
    longer = fmpy.simulate_fmu(unit, stop_time=1.0, output_interval=0.1, start_values={"par.L": 1.2})

here = sf.simulate(sf.compile(pendulum), {"q": 0.5}, t_end=1.0, dt=1e-3, output=0.1)
print(f"FMPy and sf.simulate differ by {np.abs(there['q.q'] - here['q']).max():.1e} rad")
print(f"after 1 s: {there['q.q'][-1]:.4f} rad, of a rod of 1.2 m {longer['q.q'][-1]:.4f} rad")
