"""Speed against accuracy: what is run, what is kept of it, and the report."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict
from typing import Annotated, Any

import typer

from validation.pareto import verdicts
from validation.pareto.catalogue import SCENES
from validation.pareto.figures import figure, letters, models_chart
from validation.pareto.front import charted, front
from validation.pareto.race import Result, race
from validation.pareto.scene import Point, Scene
from validation.reporting.command import Done, Quick, Run, known
from validation.reporting.numbers import counted, duration, finite, short, times
from validation.reporting.provenance import machine, now
from validation.reporting.record import (
    Block,
    Bullets,
    Cell,
    Data,
    Fact,
    Fold,
    Report,
    Section,
    Table,
    Text,
    Topic,
    failure_texts,
    verdict_word,
)

ENGINES = ("mujoco", "exudyn", "pin")
INTRO = (
    "Error against time, both logarithmic. One thread; times are those of the processor, of the stepping alone, "
    "least of up to nine repeats; models are compiled, and engines' systems assembled, before. Both sides record at "
    "the same interval. An engine's best is the best of all its runs here. Between two steps of one method times are "
    "interpolated, between methods or models they are not. A fixed step that a solver can't finish ends its run.",
    "Accelerations in single precision are a series of their own on the rigid arm: the generated code has floats for "
    "batches alone, so a motion by itself pays for all lanes of a vector and uses one; what batches gain is in the "
    "report on timing.",
)


def measure(
    run: Run,
    chosen: Annotated[list[str] | None, typer.Option("--scene", help=f"Only this; of {', '.join(SCENES)}.")] = None,
    quick: Quick = False,
    resume: Annotated[bool, typer.Option("--resume", help="Leave out scenes that pareto.json has.")] = False,
) -> Data:
    """Compare speed at equal accuracy: our models and methods, and engines with their own integrators.

    Scenes that are not run again keep the results that pareto.json has of them; those of --quick have a subfolder.
    """
    names = known(chosen, SCENES, "--scene", "scene")
    if quick:
        run.folder = run.folder / "pareto_quick"
    kept = _kept(run, quick)
    names = [name for name in names if not (resume and name in kept)]

    def raced(name: str) -> dict[str, Any]:
        run.expect(1, f"{name}: references")
        result = race(SCENES[name], quick, lambda count: run.expect(count, name), run.advance)
        return scene_data(SCENES[name], result, now())

    def data(done: Done) -> dict[str, Any]:
        scenes = kept | done.results
        whole = Done(scenes, done.failures, done.unfinished)
        ok = all(scene["ok"] for scene in scenes.values())
        return run.head(ok, whole, *ENGINES, quick=quick) | {"scenes": {n: scenes[n] for n in SCENES if n in scenes}}

    # Each is kept as soon as it is done.
    return data(run.each(names, raced, lambda done: run.save(data(done))))


def _kept(run: Run, quick: bool) -> dict[str, Any]:
    """What an earlier run left on this machine, in the same way: scenes by name."""
    path = run.folder / "pareto.json"
    data = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}
    if not data or data["quick"] != quick or data["machine"] != machine():
        return {}
    return {name: scene for name, scene in data["scenes"].items() if name in SCENES}


def scene_data(scene: Scene, result: Result, date: str) -> dict[str, Any]:
    """A scene that was run, for JSON."""
    judged = verdicts.verdicts(scene, result.points)
    points = [asdict(p) | {"error": finite(p.error), "seconds": finite(p.seconds)} for p in result.points]
    return {
        "title": scene.title,
        "measure": scene.measure,
        "ok": result.agreement <= scene.trust and all(v.ok for v in judged),
        "date": date,
        "agreement": finite(result.agreement),
        "trust": scene.trust,
        "references": result.references,
        "floors": dict(result.floors),
        "seconds": round(result.seconds, 1),
        "targets": [
            asdict(v.target) | {"found": "only ours" if math.isinf(v.ratio) else finite(v.ratio), "ok": v.ok}
            for v in judged
        ],
        "words": [*verdicts.compared(scene, result.points), *verdicts.advice(scene, result)],
        "front": [point.name for point in front(charted(scene, result.points))],
        "points": points,
    }


def result_of(scene: Data) -> Result:
    """The result that `scene_data` wrote."""

    def real(x: float | None) -> float:
        return math.nan if x is None else float(x)

    points = tuple(Point(**p | {"error": real(p["error"]), "seconds": real(p["seconds"])}) for p in scene["points"])
    return Result(points, real(scene["agreement"]), scene["references"], scene["floors"], scene["seconds"])


def compose(data: Data) -> Report:
    """The report of its JSON."""
    results = {name: (SCENES[name], result_of(scene)) for name, scene in data["scenes"].items()}
    failures, unfinished = data["failures"], tuple(data["unfinished"])
    targets = [target for scene in data["scenes"].values() for target in scene["targets"]]
    met = sum(target["ok"] for target in targets)
    runs = sum(len(result.points) for _, result in results.values())
    doubted = [name for name, (scene, result) in results.items() if not result.agreement <= scene.trust]
    said = f"{met} of {counted(len(targets), 'target')} met, in {counted(len(results), 'scene')}"
    said += " (quick variant: few contestants, so its ratios mean little)" if data["quick"] else ""
    said += f"; references disagree on {', '.join(doubted)}" if doubted else ""
    said += f"; {counted(len(failures), 'scene')} could not be done" if failures else ""
    said += f"; interrupted before {', '.join(unfinished)}" if unfinished else ""
    most = max((t["found"] for t in targets if isinstance(t["found"], float)), default=0.0)
    table = _targets(results)
    advice = tuple(
        f"**{scene.title}.** {_which(scene, result)} {verdicts.methods(scene, result)}"
        for scene, result in results.values()
    )
    which: tuple[Block, ...] = (verdicts.overall(results), table, Bullets(advice))
    first = next(iter(results.values()), None)
    return Report(
        "Speed against accuracy",
        f"{said}.",
        bool(data["ok"]),
        (*INTRO, *failure_texts(failures)),
        (
            Section("Which to use when", which, "which"),
            *(_section(name, *results[name], scene, data["quick"]) for name, scene in data["scenes"].items()),
        ),
        (
            Fact(f"{met} of {len(targets)}", "targets are met", met == len(targets)),
            Fact(str(runs), f"ways through {counted(len(results), 'scene')}"),
            Fact(times(most), "an engine's best time over ours, at equal error, where it is most"),
        ),
        (models_chart(*first),) if first else (),
        (table, *failure_texts(failures)),
        unfinished,
    )


def _targets(results: Mapping[str, tuple[Scene, Result]]) -> Table:
    head = ("scene", "#at error", "against", "#ours", "#its best", "#ratio", "#asked", "verdict")
    rows = [
        (
            f"[{scene.title}](#{name})",
            scene.shown(v.target.error),
            v.target.engine,
            duration(v.seconds),
            duration(v.engine_seconds),
            Cell("only ours" if math.isinf(v.ratio) else f"{v.ratio:.3g}", v.ok),
            short(v.target.ratio),
            verdict_word(v.ok),
        )
        for name, (scene, result) in results.items()
        for v in verdicts.verdicts(scene, result.points)
    ]
    return Table(head, tuple(rows))


def _which(scene: Scene, result: Result) -> str:
    return " ".join([*verdicts.compared(scene, result.points), verdicts.below_the_floor(scene, result)]).strip()


def _section(name: str, scene: Scene, result: Result, data: Data, quick: bool) -> Section:
    best = front(charted(scene, result.points))
    rows = tuple(
        (letter, p.who, p.model, p.method, p.setting, scene.shown(p.error), duration(p.seconds))
        for letter, p in zip(letters(len(best)), best, strict=True)
    )
    trusted = result.agreement <= scene.trust
    agree = scene.shown(result.agreement)
    command = f"python -m validation pareto --scene {name}{' --quick' if quick else ''}"
    blocks: tuple[Block, ...] = (
        f"{scene.setting} **Error:** {scene.measure}.",
        figure(scene, result, verdicts.see(scene, result)),
        Text(f"**Which when.** {_which(scene, result)}", "advice"),
        Table(("run", "who", "model", "method", "step or tolerance", "#error", "#time"), rows),
        f"**Tuned:** {scene.tuned}",
        Text(
            f"**References:** {result.references}. They agree to {agree}; asked for is {scene.shown(scene.trust)}.",
            "plain" if trusted else "bad",
        ),
        Fold(
            f"{len(result.points)} runs; those that did not come to their end",
            (Bullets(tuple(verdicts.refused(result))),),
            page_only=True,
        ),
        Text(f"`{command}`, {result.seconds:.0f} s, {data['date']}. Sources: {'; '.join(scene.sources)}.", "soft"),
    )
    return Section(scene.title, blocks, name, bool(data["ok"]))


TOPIC = Topic("pareto", "Accuracy against time", "Which model is the cheapest that is good enough?", compose)
