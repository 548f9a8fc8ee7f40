"""Small models of MJCF by Newton's reader, as its MuJoCo solver states them to MuJoCo."""

from __future__ import annotations

from ...interface import STEP
from ...truth.devices import DEVICES
from ..mujoco.devices import ANSWER, SLOTS
from ..writing.source import Source, Way
from .ways import IMPORTS

# Weight, steps and what ends iterations are the solver's own, which the file does not state to it.
_COMPILED = f"""import mujoco as mj
def compiled(text):
    b = newton.ModelBuilder()
    newton.solvers.SolverMuJoCo.register_custom_attributes(b)
    b.add_mjcf(text)
    m = newton.solvers.SolverMuJoCo(b.finalize(device="cpu"), use_mujoco_cpu=True).mj_model
    m.opt.timestep, m.opt.gravity[:], m.opt.tolerance, m.opt.iterations = {STEP}, 0.0, 0.0, 20
    return m"""
# What its reader knows of actuators, tendons and constraints: no states, delays and polynomials, no sensors.
GROUPS = ("drives", "transmissions", "solver's parameters")
_UNKNOWN = (
    *("drive_servo_of_damping_ratio_and_gear", "drive_servo_filtered", "drive_cylinder", "drive_pid", "drive_bears"),
    *("drive_dc_motor_controller", "drive_dc_motor_passive", "drive_delayed", "ball_servo", "ball_oriented"),
    *("tendon_clipped_sensor", "tendon_clipped_with_gear", "adhesion", "limit_force", "limit_of_ball"),
)
WAYS = {
    name: Way(f"add_mjcf, SolverMuJoCo: {device.about}", device.code)
    for group in GROUPS
    for name, device in DEVICES[group].items()
    if not name.startswith(_UNKNOWN)
}


def write_devices() -> Source:
    """Text that answers of any of them."""
    return Source((*IMPORTS, *_COMPILED.split("\n"), *ANSWER.split("\n")), SLOTS, 4, 3)
