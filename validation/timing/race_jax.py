"""Forward dynamics of Panda's seven joints in JAX: `sf.interop.jax` beside frax, in one run.

    pip install 'symofros[jax,engine-frax]'
    python -m validation.timing.race_jax

Both are jitted and vmapped over the same states, in double precision on the CPU; frax is written in JAX and gets the
settings that it recommends. Turns alternate; the least time of many is told, and how far the results differ.
"""

from __future__ import annotations

import os
import re
import tempfile
import time
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

import symofros as sf
from validation.timing.models import panda7

STATES, TURNS = 4096, 15
SETTINGS = {
    "JAX_ENABLE_X64": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "XLA_FLAGS": "--xla_cpu_multi_thread_eigen=false --xla_cpu_scheduler_type=CPU_SCHEDULER_TYPE_MEMORY_OPTIMIZED",
    "FRAX_SUPPRESS_WARNINGS": "1",
}
# frax wants an inertia of every link: any of the base, which stands still, none of others that have no mass.
_INERTIAL = '<inertial><mass value="{0}"/><inertia ixx="{0}" ixy="0" ixz="0" iyy="{0}" iyz="0" izz="{0}"/></inertial>'


def frax_robot(system: sf.System, joints: list[str]) -> Any:
    """The same mechanism in frax, from a URDF."""
    frax: Any = import_module("frax")
    base = system.bodies[0].name
    with tempfile.TemporaryDirectory() as folder:
        sf.export(system, "urdf", folder, name="robot")
        file = Path(folder) / "robot.urdf"

        def with_inertia(link: re.Match[str]) -> str:
            return f'<link name="{link[1]}">{_INERTIAL.format(int(link[1] == base))}</link>'

        text = file.read_text(encoding="utf-8")
        file.write_text(re.sub(r'<link name="([^"]*)"\s*/>', with_inertia, text), encoding="utf-8")
        return frax.Robot(str(file), joint_ordering=joints)


def least_times(functions: list[Any], arguments: list[Any]) -> list[float]:
    """Least time of each function on all states [s], turn by turn."""
    least = [float("inf")] * len(functions)
    for turn in range(TURNS + 1):
        for i, function in enumerate(functions):
            start = time.perf_counter()
            function(*arguments).block_until_ready()
            if turn > 0:  # The first one compiles.
                least[i] = min(least[i], time.perf_counter() - start)
    return least


def main() -> None:
    """Print the race."""
    os.environ.update(SETTINGS)
    jax: Any = import_module("jax")  # After the settings, which it reads.
    jax.config.update("jax_enable_x64", True)
    system = panda7()
    model = sf.compile(system)
    robot, dynamics = frax_robot(system, list(model.names.q)), sf.interop.jax.Dynamics(model)
    rng = np.random.default_rng(1)
    states = [jax.numpy.asarray(rng.uniform(-1, 1, (STATES, model.nv))) for _ in "qvu"]

    def theirs(q: Any, v: Any, u: Any) -> Any:
        return robot.forward_dynamics(q, v, u, None)

    functions = [jax.jit(jax.vmap(function)) for function in (dynamics.forward_dynamics, theirs)]
    far = float(abs(functions[0](*states) - functions[1](*states)).max())
    ours, other = (1e9 * seconds / STATES for seconds in least_times(functions, states))
    print(f"jax {jax.__version__}, forward dynamics, {STATES} states a call, ns a state:")
    print(f"  symofros {ours:.0f}, frax {other:.0f}, {other / ours:.0f} times; largest difference {far:.1e}")


if __name__ == "__main__":
    main()
