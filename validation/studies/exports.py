"""What a call costs in each environment, how long the longest of a million is, and how big a package is."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

import symofros as sf

from ..inputs.cases import robot_case
from ..reporting.command import Run
from ..reporting.figures import Chart, Figure, curves
from ..reporting.numbers import formatted
from ..reporting.plain import plain
from ..reporting.record import Data, Fact, Report, Section, Table, Topic

ROBOT = "xarm7"
CALLS = 1_000_000
_PYTHON_CALLS = 20_000
_FLAGS = ("-O2", "-std=c99", "-fno-math-errno")
_NATIVE = Path(__file__).parent.parent / "native" / "latency.c"


@dataclass(frozen=True)
class Latency:
    """One kind of call in C.

    Attributes:
        name: Name of what was called.
        median: Median [ns], the clock's own cost included.
        high: Bound that 99.9 % stay below [ns].
        worst: The longest [ns].
        bins: Calls below 2, 4, 8, ... ns.
    """

    name: str
    median: float
    high: float
    worst: float
    bins: tuple[int, ...]


@dataclass(frozen=True)
class ExportStudy:
    """The figures of one run.

    Attributes:
        model: Name, and sizes.
        calls: Number of calls of each latency.
        latencies: Latencies in C, one a kind.
        overheads: Environment -> what is called -> mean time of a call [ns]; None where a tool is missing.
        bytes: Part -> size.
    """

    model: str
    calls: int
    latencies: tuple[Latency, ...]
    overheads: dict[str, dict[str, float | None]]
    bytes: dict[str, int]


def run_study(calls: int = CALLS) -> ExportStudy:
    """Export a seven-joint arm, build it, and call it from everywhere."""
    system = robot_case(ROBOT).load().system
    with tempfile.TemporaryDirectory(prefix="symofros-exports-") as private:
        folder = Path(private)
        package = folder / "c"
        name = sf.export(system, "c", package).name
        model = sf.compile(system)
        latencies = _latencies(package, name, calls)
        by_name = {latency.name: latency.median for latency in latencies}
        clock = by_name["clock"]
        overheads: dict[str, dict[str, float | None]] = {
            "C": {"M, h, Q": by_name["dynamics"] - clock, "step of 1 ms": by_name["rk4_step"] - clock},
            "Python": _python(model),
            "MEX, Octave": _mex(system, folder / "mex", name),
            "FMU 2.0 by FMPy": {"M, h, Q": None, "step of 1 ms": _fmu(system, folder / "fmu")},
        }
        return ExportStudy(f"{ROBOT}: {model.nv} speeds", calls, latencies, overheads, _sizes(package, name))


def _command(*words: str | Path, cwd: Path) -> str:
    done = subprocess.run([str(word) for word in words], cwd=cwd, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(map(str, words))}\n{done.stderr[:2000]}")
    return done.stdout


def _latencies(package: Path, name: str, calls: int) -> tuple[Latency, ...]:
    parts = [f"{name}.c", f"{name}_plant.c", "symofros_stepper.c"]
    _command("cc", *_FLAGS, "-I.", f"-DNAME={name}", "-o", "latency", _NATIVE, *parts, "-lm", cwd=package)
    latencies = []
    for line in _command("./latency", str(calls), cwd=package).splitlines():
        label, median, high, worst, *bins = line.split()
        latencies.append(Latency(label, float(median), float(high), float(worst), tuple(map(int, bins))))
    return tuple(latencies)


def _python(model: sf.Model) -> dict[str, float | None]:
    q, v, u = model.neutral(), np.zeros(model.nv), np.zeros(model.nu)
    model.dynamics(q, v, u)
    start = time.perf_counter()
    for _ in range(_PYTHON_CALLS):
        model.dynamics(q, v, u)
    call = (time.perf_counter() - start) / _PYTHON_CALLS * 1e9
    model_steps = sf.simulate(model, q, v, 1.0, dt=1e-3).statistics
    return {"M, h, Q": call, "step of 1 ms": model_steps.seconds / model_steps.steps * 1e9}


def _mex(system: sf.System, folder: Path, name: str) -> dict[str, float | None]:
    if shutil.which("octave-cli") is None:
        return {"M, h, Q": None, "step of 1 ms": None}
    sf.export(system, "mex", folder, frames=[])
    code = (
        f"build_{name}; [d, s, f, p] = {name}(0); X = s.X0; U = s.U0; P = p.values; n = {_PYTHON_CALLS};"
        f"tic; for i = 1:n, end; e = toc; tic; for i = 1:n, [M, g] = {name}(1, X, U, P); end;"
        "printf('%.17g ', (toc - e) / n * 1e9);"
        f"tic; [t, Y] = {name}(9, X, U, P, [0 1 1e-3]); printf('%.17g', toc / (numel(t) - 1) * 1e9);"
    )
    call, step = _command("octave-cli", "-qf", "--eval", code, cwd=folder).split()[-2:]
    return {"M, h, Q": float(call), "step of 1 ms": float(step)}


def _fmu(system: sf.System, folder: Path) -> float:
    import fmpy  # Of an extra: other targets are measured without it.
    from fmpy.fmi2 import FMU2Slave  # As above.

    done = sf.export(system, "fmu2", folder, frames=None)
    place = folder / "unzipped"
    fmpy.extract(str(done.files[0]), str(place))
    description = fmpy.read_model_description(str(done.files[0]))
    fmu: Any = FMU2Slave(guid=description.guid, unzipDirectory=str(place), modelIdentifier=done.name, instanceName="it")
    fmu.instantiate()
    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    start = time.perf_counter()
    for i in range(1000):
        fmu.doStep(i * 1e-3, 1e-3)
    taken = time.perf_counter() - start
    fmu.freeInstance()
    return taken / 1000 * 1e9


def _sizes(package: Path, name: str) -> dict[str, int]:
    sizes = {
        f"{name}.c": (package / f"{name}.c").stat().st_size,
        "symofros_stepper.c": (package / "symofros_stepper.c").stat().st_size,
    }
    for part in (name, "symofros_stepper"):
        _command("cc", *_FLAGS, "-c", f"{part}.c", "-o", f"{part}.o", cwd=package)
        lines = [line.split() for line in _command("size", "-A", f"{part}.o", cwd=package).splitlines()]
        sections = {words[0]: int(words[1]) for words in lines if words and words[0].startswith(".")}
        held = (".text", ".rodata", ".data.rel.ro", ".eh_frame")
        sizes[f"{part}.o: code and constants"] = sum(n for name, n in sections.items() if name.startswith(held))
        sizes[f"{part}.o: data that is written to"] = sections.get(".data", 0) + sections.get(".bss", 0)
    return sizes


def measure(_: Run, calls: Annotated[int, typer.Option(min=1000, help="Calls of each kind in C.")] = CALLS) -> Data:
    """Time calls of an exported seven-joint arm: C, Python, MEX, FMU; and the worst case in C."""
    return dict(plain(run_study(calls)))


_LIMITS = """The machine runs other work and no real-time kernel: the median and 99.9 % say what the code takes, the
longest call how long the operating system was away. Each call is timed by itself; the clock's own cost is the row
`clock`, subtracted in the first table. M, h, Q from Octave and Python are means over a loop in their own language;
steps from there are those of one call that makes a thousand. FMPy's ctypes call is most of the difference between the
FMU and C. The block for Simulink ran against a stand-in header, not in Simulink."""
_SEE = """Each peak is what the code takes; what lies a decade to the right is the operating system, as with the bare
clock."""


def compose(data: Data) -> Report:
    """The report of its JSON."""
    overheads, latencies, calls = data["overheads"], data["latencies"], f"{data['calls']:,}".replace(",", " ")
    tasks = list(overheads["C"])
    costs = (
        (where, *(formatted(row[task] and row[task] / 1e3, ".2f") for task in tasks))
        for where, row in overheads.items()
    )
    worst = ("{name} | {median:.0f} | {high:.0f} | {worst:.0f}".format_map(row) for row in latencies)
    # Bin i ends at 2^(i + 1) ns.
    used = [i for i, column in enumerate(zip(*(row["bins"] for row in latencies), strict=True)) if any(column)]
    counts = {row["name"]: [row["bins"][i] for i in used] for row in latencies}
    ends = [2 << i for i in used]
    axes = "time of a call, upper end of its bin  [ns]", "calls  [1]"
    chart = Chart("calls by time", *axes, curves(ends, counts), log="xy")
    bins = (map(str, row) for row in zip(ends, *counts.values(), strict=True))
    return Report(
        "Exports: what a call costs",
        f"{data['model']}: the cost of calls from {', '.join(overheads)}.",
        None,
        (_LIMITS,),
        (
            Section("From where", (Table.of(" | ".join(["from", *(f"{task} [µs]" for task in tasks)]), costs),)),
            Section(
                f"Worst case of {calls} calls in C",
                (
                    Table.of("call | median [ns] | 99.9 % [ns] | longest [ns]", worst),
                    Figure(_SEE, (chart,)),
                    Table.of(" | ".join(["below [ns]", *counts]), map(tuple, bins)),
                ),
                "worst_case",
            ),
            Section(
                "Size of the C package",
                (Table.of("part | size [bytes]", (f"{part} | {size:,}" for part, size in data["bytes"].items())),),
            ),
        ),
        facts=(
            *(
                Fact(f"{row['step of 1 ms'] / 1e3:.2g} µs", f"a step of 1 ms from {where}")
                for where, row in overheads.items()
                if row.get("step of 1 ms") is not None
            ),
            Fact(f"{max(row['high'] for row in latencies) / 1e3:.2g} µs", f"99.9 % of {calls} calls in C are below"),
        ),
    )


TOPIC = Topic("exports", "Speed", "What does a call cost from C, Python, MEX, an FMU?", compose, measure)
