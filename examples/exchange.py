"""The paper's task: one arm takes hold of a station, the other exchanges a part; as files, as a film, and as C."""

import subprocess
import tempfile
from pathlib import Path

import numpy as np
from symofros.reference_models.diagrams.exchange import T_END, exchanging

import symofros as sf

folder = Path(tempfile.mkdtemp())
files = sf.save_diagram(exchanging(), folder / "exchange.yaml")  # Mechanisms, blocks, events: all of it is in files.
print("files:", ", ".join(path.name for path in files))

diagram = sf.load_diagram(folder / "exchange.yaml")
run = sf.Simulation(diagram).run(T_END, dt=1e-3, record=0.02)
print("outcome:", run.outcome)
print(f"{T_END / run.cost.worked:.1f} s of motion a second")
for met in run.events["plant"]:
    print(f"{met.t:5.1f} s  {met.name:14} {met.energy_lost:8.1e} J lost, impulse {np.abs(met.impulse).max():8.1e}")
print("spare part at the end [m]", run["spare.p"][-1].round(3))
print("film:", sf.record(run, folder / "exchange.html", speed=4.0, rate=5.0))  # A page; .mp4 and .gif are films, too.

package = sf.export(diagram, "c", folder / "c", dt=1e-3)
subprocess.run(["cmake", "-S", folder / "c", "-B", folder / "build"], check=True, stdout=subprocess.DEVNULL)
subprocess.run(["cmake", "--build", folder / "build"], check=True, stdout=subprocess.DEVNULL)
print(subprocess.run([folder / "build" / "exchange", "--check"], check=True, capture_output=True, text=True).stdout)
