"""A session of a campaign: from a plan and a folder to the batches that are left, the one file, the summary."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rich.console import Console

import symofros as sf

from ..reporting import provenance
from ..reporting.command import progress_bar
from ..reporting.evidence import digest
from .errors import PlanError, StoreError, Unfinished
from .plan import Plan, SweepPlan, as_text, cases, identities, make, plan_hash
from .runner import Pool, run, sources
from .store import RESULTS, Store, manifest_of, provenance_of
from .summary import effort, summarised
from .sweep import Sweeper
from .tasks import Task, tasks


def begin(plan: Plan, folder: Path, pool: Pool) -> dict[str, Any]:
    """Carry out a plan, from where its folder stands.

    Returns:
        The summary.

    Raises:
        Unfinished: Some batches are missing.
        PlanError: A model is not there, or not what the plan takes it for.
        StoreError: The folder is another campaign's, or in use.
        OSError: The folder can't be written to, or a cluster is not there.
    """
    if isinstance(plan, SweepPlan):
        try:
            Sweeper(plan, cases(plan)[0])
        except sf.SymofrosError as error:
            raise PlanError(plan.model, str(error), "a sweep names what its model has", "mend the plan") from None
    return _carry_out(Store.create(folder, _manifest(plan)), plan, pool)


def continue_campaign(folder: Path, pool: Pool) -> dict[str, Any]:
    """Continue an unfinished campaign; returns and raises as `begin`."""
    plan = make(manifest_of(folder)["plan"], str(folder / "plan.json"))
    return _carry_out(Store.agreeing(folder, _manifest(plan)), plan, pool)


def standing(folder: Path) -> dict[str, Any]:
    """The summary of a campaign that is done; of another how far it is: `finished` of `size`, `batches` of `of`.

    Raises:
        StoreError: There is no campaign.
    """
    manifest = manifest_of(folder)
    store = Store(folder, manifest["hash"])
    if store.results.is_file():
        return _summary(store)
    plan = make(manifest["plan"], str(folder / "plan.json"))
    wanted, (parts, _) = tasks(plan), store.finished()
    finished = sum(task.size for task in wanted if task.number in parts)
    return {"finished": finished, "size": plan.size, "batches": len(parts), "of": len(wanted)}


def _manifest(plan: Plan) -> dict[str, Any]:
    models = identities(cases(plan))
    return {
        "hash": plan_hash(plan, models),
        "plan": json.loads(as_text(plan)),
        "models": models,
        "versions": provenance.versions() | sources(),
        "begun": provenance.now(),
    }


def _carry_out(store: Store, plan: Plan, pool: Pool) -> dict[str, Any]:
    with store.lock():
        if not store.results.is_file():
            _complete(store, plan, pool)
        elif store.parts.is_dir():
            store.tidy()  # Killed between the two steps of merging.
        return _summary(store)


def _complete(store: Store, plan: Plan, pool: Pool) -> None:
    """Every part, and the one file."""
    wanted, (finished, damaged) = tasks(plan), store.finished()
    for part, why in damaged.items():
        Console(stderr=True).print(f"{part} is damaged, its batch is done again: {why}", markup=False, soft_wrap=True)
    left = [task for task in wanted if task.number not in finished]
    store.note(event="session", left=len(left))
    try:
        with _bar(plan.size, plan.size - sum(task.size for task in left)) as done:
            failures = run(store, left, pool, done) if left else {}
    except KeyboardInterrupt:
        raise Unfinished(store.folder, []) from None
    if failures:
        raise Unfinished(store.folder, list(failures.values()))
    manifest = manifest_of(store.folder)
    metadata = {
        **{name: manifest[name] for name in ("hash", "plan", "begun")},
        "identities": manifest["models"],
        "effort": effort(store.journal()),
        "sources": sources(),
        **provenance.stamp(),
        "digest": digest("campaigns"),
    }
    store.merge(len(wanted), metadata)


@contextmanager
def _bar(size: int, before: int) -> Iterator[Callable[[Task], None]]:
    """Progress on the error stream: a bar with rate and time left for a terminal, a line every tenth for a file."""
    console = Console(stderr=True)
    with progress_bar(console) as bar:
        shown = bar.add_task("starting", total=size, completed=before)

        def done(task: Task) -> None:
            past = bar.tasks[0]
            tenth = int(10 * past.completed / size)
            rate = f", {past.speed:.0f}/s" if past.speed else ""
            bar.update(shown, advance=task.size, description=f"{task.title}{rate}")
            if not console.is_terminal and int(10 * past.completed / size) > tenth:
                console.print(f"{past.completed:.0f} of {size}", markup=False)

        yield done


def _summary(store: Store) -> dict[str, Any]:
    facts = provenance_of(store.results)
    if facts["hash"] != store.hash:
        rule = "plan and results belong together"
        raise StoreError(store.folder, f"{RESULTS} is of another plan", rule, "begin anew in a new folder")
    return summarised(store.rows(), facts)
