"""Is the code equal to that of a frozen commit? Both run side by side on this machine, with the same flags.

python .ci/goldens.py COMMIT                      # text, values and runs of both trees; verdicts of the stored reports
python .ci/goldens.py COMMIT --only times         # and times in alternating processes, on a quiet machine

| part | what is compared | equal |
|---|---|---|
| text | C of every reference model, as a package has it | digest, or else the operations; the bits are part of values |
| values | functions of every reference model, interpreted, at random states | bits |
| runs | ten motions of each kind: trees, loops, rolling, beams, exact rods, events, inputs, batches, diagrams | bits |
| verdicts | cells of `check` and `engines`, faults caught, as the reports of both trees say | none lost |
| times | generated functions, and making their text, in pairs | within 3 %, or within twice the noise |

What differs is listed with its size: the largest difference, relative to the largest entry. Only public names are used,
so that one probe serves both trees. Exit code: 0 all is equal, 1 something differs.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import re
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator
from functools import partial
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
PARTS = ("text", "values", "runs", "verdicts", "times")
FUNCTIONS = ("mass_matrix", "bias", "kinetic_energy", "potential_energy", "inverse_dynamics", "forward_dynamics")
CONSTRAINED = ("constraint_jacobian", "constraint_bias")
FIXED, ADAPTIVE = ("euler", "semi_implicit_euler", "rk4"), ("dopri5", "dop853", "rodas4")
OF_THEIR_OWN_STEPS = (*ADAPTIVE, "cvode", "ida")
# Kind -> models and methods of its ten motions.
RUNS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "trees": (("double_pendulum", "friction_arm"), (*FIXED, *ADAPTIVE[:2])),
    "quaternions": (("heavy_top", "torque_free_body"), ("rk4", *ADAPTIVE, "variational")),
    "loops": (("four_bar", "slider_crank"), ("rk4", "dopri5", "rodas4", "generalized_alpha", "ida")),
    "rolling": (("rolling_disc", "sleigh"), ("rk4", "dopri5", "dop853", "rodas4", "generalized_alpha")),
    "beams": (("flexible_pendulum", "planar_robot"), ("rk4", "dopri5", "rodas4", "generalized_alpha", "cvode")),
    "rods": (("soft_pendulum", "spatial_rod"), ("rodas4", "dop853", "generalized_alpha", "implicit_euler", "cvode")),
}
STARTS = {"rolling_disc": [0.0, 0.0, 0.5, 0.5, 0.5, 0.5, 0.5], "four_bar": [1.2, -1.2, 1.2]}
TIMED = ("panda", "talos", "mss", "chain52", "planar_robot", "spatial_rod")
ROBOTS = {"panda": "/panda_description/urdf/panda.urdf", "talos": "/talos_data/robots/talos_reduced.urdf"}
ROUNDS, SPAN = 7, 0.05  # Processes a tree; seconds a measurement.
ALLOWED = 1.03
FAILED = "failed: "

# --- The probe: runs in a process of its own, in either tree. ---------------------------------------------------------


def state_of(model: Any) -> tuple[Any, Any]:
    """A random state, on the constraints."""
    import symofros as sf

    q, v = model.random_state(np.random.default_rng(3))[:2]
    if not model.nc:
        return q, v
    start = sf.assemble(model, STARTS.get(model.record.name, model.neutral()), 0.3 * np.ones(model.nv))
    return start.q, start.v


def flat(value: Any) -> Any:
    """All numbers of a result in one row."""
    parts = value if isinstance(value, tuple | list) else (value,)
    return np.concatenate([np.asarray(part, float).ravel() for part in parts])


def stepping(method: str, dt: float) -> dict[str, Any]:
    """A method, and the step of those that do not choose theirs."""
    return {"method": method} | ({} if method in OF_THEIR_OWN_STEPS else {"dt": dt})


def texts() -> Iterator[tuple[str, Callable[[], Any]]]:
    """Digest of the C of each model, and how many operations it has."""
    import reference_models
    import symofros as sf

    def text(name: str) -> str:
        system, start = reference_models.MODELS[name], None
        if name in STARTS:
            model = sf.compile(system)
            start = dict(zip(model.names.q, map(float, state_of(model)[0]), strict=True))
        with tempfile.TemporaryDirectory() as folder:
            sf.export(system, "c", Path(folder) / "out", name="model", start=start)
            files = sorted(Path(folder).rglob("model*.c"))
            assert files, "no C"
            code = "".join(path.read_text() for path in files)
        bare = re.sub(r"/\*.*?\*/|//[^\n]*|#[^\n]*", "", code, flags=re.DOTALL)
        counts = {sign: bare.count(f" {sign} ") for sign in "+-*/"}
        return f"{hashlib.sha256(code.encode()).hexdigest()} {counts}"

    for name in reference_models.MODELS:
        yield name, partial(text, name)


def values() -> Iterator[tuple[str, Callable[[], Any]]]:
    """Functions of each model, interpreted, at two states."""
    import reference_models
    import symofros as sf

    def called(name: str) -> Any:
        system = reference_models.MODELS[name]
        functions = FUNCTIONS + (CONSTRAINED if system.constraints else ())
        model = sf.compile(system, sf.Options(functions=functions, backend="interpreter"))
        rng, results = np.random.default_rng(5), []
        for _ in range(2):
            q = model.random_state(rng)[0]
            v, a, u = rng.standard_normal(model.nv), rng.standard_normal(model.nv), rng.standard_normal(model.nu)
            given = {
                "mass_matrix": (q,), "potential_energy": (q,), "constraint_jacobian": (q,), "bias": (q, v),
                "kinetic_energy": (q, v), "constraint_bias": (q, v), "inverse_dynamics": (q, v, a),
            }  # fmt: skip
            results += [flat(getattr(model, f)(*given[f], u=u)) for f in functions if f in given]
            results += [flat(model.forward_dynamics(q, v, u))]
        return np.concatenate(results)

    for name in reference_models.MODELS:
        yield name, partial(called, name)


def motions() -> Iterator[tuple[str, Callable[[], Any]]]:
    """Ten motions of each kind."""
    import reference_models
    import symofros as sf
    from symofros import blocks

    def model_of(name: str) -> Any:
        return sf.compile(reference_models.MODELS[name])

    def row(motion: Any) -> Any:
        return flat([motion.t, motion.q, motion.v, len(motion.outcome.notes)])

    def run(name: str, method: str) -> Any:
        model = model_of(name)
        return row(sf.simulate(model, *state_of(model), 0.05, **stepping(method, 1e-3)))

    for kind, (names, methods) in RUNS.items():
        for name in names:
            for method in methods:
                yield f"{kind}: {name}, {method}", partial(run, name, method)

    def event(method: str, stops: bool) -> Any:
        looked_for = {"crossing": sf.Event("q1 - 1", "both", stops)}
        start = [0.3, 0.2], [-1.0, 0.0]
        motion = sf.simulate(model_of("double_pendulum"), *start, 2.0, events=looked_for, **stepping(method, 5e-3))
        return np.concatenate([row(motion), flat([one.t for one in motion.events])])

    for method in ("rk4", *ADAPTIVE, "cvode"):
        for stops in (False, True):
            yield f"events: {method}, {'ends' if stops else 'goes on'}", partial(event, method, stops)

    def driven(law: Any, method: str) -> Any:
        return row(sf.simulate(model_of("cart_pole"), t_end=1.0, u={"F": law}, **stepping(method, 2e-3)))

    laws: dict[str, Any] = {
        "formula": "sin(3*t)", "pulse": "20*exp(-1e4*(t - 0.3)^2)", "corner": "abs(sin(9*t))", "number": 0.3,
        "samples": sf.Signal(np.linspace(0, 1, 41), np.sin(np.arange(41.0))),
    }  # fmt: skip
    for title, law in laws.items():
        for method in ("rk4", "dopri5"):
            yield f"inputs: {title}, {method}", partial(driven, law, method)

    def batch(name: str, method: str) -> Any:
        model = model_of(name)
        rng = np.random.default_rng(5)
        q, v = (np.array(part) for part in zip(*(model.random_state(rng)[:2] for _ in range(6)), strict=True))
        motion = sf.simulate_batch(model, q, v, 0.05, output=0.01, threads=2, **stepping(method, 5e-3))
        return flat([motion.q, motion.v])

    for name in ("friction_arm", "double_pendulum"):
        for method in (*FIXED, *ADAPTIVE[:2]):
            yield f"batches: {name}, {method}", partial(batch, name, method)

    def diagram(method: str, period: float) -> Any:
        drawn = sf.Diagram("pushed")
        drawn.add_model("plant", reference_models.MODELS["cart_pole"])
        drawn.add(
            blocks.PythonBlock(
                name="law", function=lambda t, _: {"force": [0.3 - t]}, outputs={"force": (1,)}, period=period
            )
        )
        drawn.add(blocks.ForwardDynamics(name="plant", model="plant"), u="law.force")
        done = sf.Simulation(drawn).run(0.1, dt=0.005, method=method)
        return flat([done.t, *(done[name] for name in done)])

    for method in (*FIXED, *ADAPTIVE[:2]):
        for period in (0.02, 0.005):
            yield f"diagrams: {method}, {period} s", partial(diagram, method, period)


def timed() -> Iterator[tuple[str, Callable[[], Any]]]:
    """Seconds a state of batches of 1024 on one thread, of a plain call, and of making the text of a package."""
    import reference_models
    import symofros as sf

    def system_of(name: str) -> Any:
        if name == "chain52":
            return reference_models.rigid.chain.chain(52)
        if name in ROBOTS:
            files = metadata.distribution("example-robot-data").files or []
            (path,) = (file.locate() for file in files if file.as_posix().endswith(ROBOTS[name]))
            return sf.load(str(path), floating_base=name == "talos")
        return reference_models.MODELS[name]

    def best(work: Callable[[], Any], count: int) -> float:
        work()
        shortest, end = np.inf, time.perf_counter() + SPAN
        while time.perf_counter() < end:
            start = time.perf_counter()
            work()
            shortest = min(shortest, time.perf_counter() - start)
        return shortest / count

    def measured(name: str) -> Any:
        model = sf.compile(system_of(name)).with_threads(1)
        rng = np.random.default_rng(1)
        q = np.array([model.random_state(rng)[0] for _ in range(1024)])
        v, u = rng.standard_normal((1024, model.nv)), rng.standard_normal((1024, model.nu))
        start = time.perf_counter()
        with tempfile.TemporaryDirectory() as folder:
            sf.export(system_of(name), "c", Path(folder) / "out", name="model", functions=("mass_matrix", "bias"))
        making = time.perf_counter() - start
        return np.array([
            best(lambda: model.mass_matrix(q), 1024), best(lambda: model.bias(q, v), 1024),
            best(lambda: model.forward_dynamics(q, v, u), 1024), best(lambda: model.mass_matrix(q[0]), 1), making,
        ])  # fmt: skip

    for name in TIMED:
        yield name, partial(measured, name)


PROBES = {"text": texts, "values": values, "runs": motions, "times": timed}
COLUMNS = ("M", "h", "v'", "M, plain call", "text")


def probe(part: str, path: str) -> None:
    """Write what a tree answers."""
    warnings.simplefilter("ignore")
    answers: dict[str, Any] = {}
    for name, work in PROBES[part]():
        try:
            answers[name] = np.asarray(work())
        except Exception as error:
            answers[name] = np.array(f"{FAILED}{type(error).__name__}: {error}"[:300])
    np.savez(path, allow_pickle=False, **{name.replace("/", "|"): answer for name, answer in answers.items()})


# --- The comparison. --------------------------------------------------------------------------------------------------


def answers_of(tree: Path, part: str, folder: Path) -> dict[str, Any]:
    """What a tree answers, by a process of its own, with models compiled anew."""
    path = folder / f"{tree.name}-{part}.npz"
    variables = os.environ | {"PYTHONPATH": str(tree), "SYMOFROS_CACHE": str(folder / f"cache-{tree.name}")}
    command = [sys.executable, str(Path(__file__).resolve()), "--probe", part, str(path)]
    subprocess.run(command, cwd=tree, env=variables, check=True)
    with np.load(path) as stored:
        return {name: stored[name] for name in stored.files}


def difference(frozen: Any, here: Any) -> str:
    """Words on how far two answers are apart; none if they have the same bits."""
    if frozen.shape == here.shape and frozen.dtype == here.dtype and frozen.tobytes() == here.tobytes():
        return ""
    if frozen.dtype.kind != "f" or here.dtype.kind != "f":
        return f"{frozen} -> {here}"
    if frozen.shape != here.shape:
        return f"{frozen.size} numbers -> {here.size}"
    largest = float(np.nanmax(np.abs(frozen), initial=0.0)) or 1.0
    return f"{float(np.nanmax(np.abs(frozen - here), initial=0.0)) / largest:.1e}"


def compared(part: str, frozen: Path, folder: Path) -> tuple[int, list[str]]:
    """How many answers there are, and those that differ."""
    before, now = (answers_of(tree, part, folder) for tree in (frozen, ROOT))
    lines = [f"{name}: missing" for name in before.keys() - now.keys()]
    for name in before.keys() & now.keys():
        words = difference(before[name], now[name])
        if str(now[name]).startswith(FAILED):  # As before or not: it shows nothing.
            words = str(now[name])
        elif part == "text" and words:
            counts = [str(side[name]).partition(" ")[2] for side in (before, now)]
            words = "" if counts[0] == counts[1] else f"operations {' -> '.join(counts)}"
        if words:
            lines.append(f"{name}: {words}")
    return len(before), sorted(lines)


def compared_times(frozen: Path, folder: Path) -> tuple[int, list[str]]:
    """Ratios of times, here over frozen, by processes that alternate; those above what is allowed."""
    rounds = [[answers_of(tree, "times", folder) for tree in (frozen, ROOT)] for _ in range(ROUNDS)]
    lines, number = [], 0
    for name in rounds[0][0]:
        sides = [np.array([pair[side][name] for pair in rounds]) for side in (0, 1)]
        ratio = sides[1].min(axis=0) / sides[0].min(axis=0)
        noise = np.max([np.median(side, axis=0) / side.min(axis=0) - 1.0 for side in sides], axis=0)
        for column, value, spread in zip(COLUMNS, ratio, noise, strict=True):
            number += 1
            print(f"  {name:14} {column:14} {value:6.3f}  noise {spread:.3f}")
            if value > ALLOWED:
                lines.append(f"{name}, {column}: {value:.3f}" + (", not decided" if value - 1 <= 2 * spread else ""))
    return number, lines


def cells(tree: Path) -> dict[str, str]:
    """Verdicts of the stored reports."""
    check, engines, mutants = (
        json.loads((tree / f"reports/{name}.json").read_text()) for name in ("check", "engines", "mutants")
    )
    found = {f"check: {c['model']}, {c['engine']}, {c['quantity']}": str(c["ok"]) for c in check["comparisons"]}
    for engine, functions in engines["cells"].items():
        for function, models in functions.items():
            found |= {f"engines: {engine}, {function}, {model}": cell[0] for model, cell in models.items()}
    for engine, identities in engines["identities"].items():
        for identity, models in identities.items():
            found |= {f"engines: {engine}, {identity}, {model}": str(cell[1]) for model, cell in models.items()}
    for share in ("check", "tests"):
        if share in mutants:
            found[f"mutants: {share}"] = json.dumps(mutants[share])
    return found


def compared_verdicts(frozen: Path, folder: Path) -> tuple[int, list[str]]:
    """Cells that are lost or have another verdict."""
    before, now = cells(frozen), cells(ROOT)
    lines = [
        f"{name}: {verdict} -> {now.get(name, 'none')}" for name, verdict in before.items() if now.get(name) != verdict
    ]
    return len(before), lines


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description="Compare this tree with a frozen commit, side by side.")
    parser.add_argument("commit", nargs="?", help="a commit of this repository")
    parser.add_argument("--only", nargs="+", choices=PARTS, default=PARTS[:4], help="these parts; all but times")
    parser.add_argument("--probe", nargs=2, help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.probe:
        probe(*asked.probe)
        return 0
    if not asked.commit:
        parser.error("a commit is wanted")
    equal = True
    with tempfile.TemporaryDirectory(prefix="goldens-") as scratch:
        folder, frozen = Path(scratch), Path(scratch) / "frozen"
        subprocess.run(["git", "worktree", "add", "-q", "--detach", frozen, asked.commit], cwd=ROOT, check=True)
        try:
            for part in asked.only:
                compare = {"verdicts": compared_verdicts, "times": compared_times}.get(part, partial(compared, part))
                number, lines = compare(frozen, folder)
                print(f"{part}: {number - len(lines)} of {number} equal", flush=True)
                for line in lines:
                    print(f"  {line}")
                equal &= all(line.endswith(", not decided") for line in lines)
        finally:
            subprocess.run(["git", "worktree", "remove", "--force", frozen], cwd=ROOT, check=False)
    return 0 if equal else 1


if __name__ == "__main__":
    sys.exit(main())
