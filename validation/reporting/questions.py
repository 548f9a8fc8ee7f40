"""A report of questions: studies are asked one by one; each answers in words, figures, and numbers with bounds."""

# Annotations are values here: the options of a command name its studies.
from collections.abc import Callable, Mapping
from typing import Annotated, Any

import typer

from validation.reporting.command import Quick, Run, known
from validation.reporting.figures import Chart, Figure
from validation.reporting.findings import Finding, Question, Study
from validation.reporting.numbers import counted
from validation.reporting.record import (
    Block,
    Compose,
    Data,
    Fact,
    Report,
    Section,
    Text,
    bounds_kept,
    failure_texts,
    findings_digest,
    findings_fold,
)


def measuring(studies: Mapping[str, Question], doc: str) -> Callable[..., Data]:
    """The function that asks studies, for `add_command`; `doc` is the command's help."""
    only = f"Only this study; repeatable. {', '.join(studies)}."

    def measure(
        run: Run, chosen: Annotated[list[str] | None, typer.Option("--study", help=only)] = None, quick: Quick = False
    ) -> Data:
        names = known(chosen, studies, "--study", "study")
        run.expect(len(names))

        def asked(name: str) -> Study:
            run.advance(name, steps=0)
            study = studies[name](quick)
            run.advance()
            return study

        done = run.each(names, asked)
        ok = all(study.ok for study in done.results.values())
        return run.head(ok, done, quick=quick) | {"studies": {name: data_of(s) for name, s in done.results.items()}}

    measure.__doc__ = doc
    return measure


def data_of(study: Study) -> dict[str, Any]:
    """A study for JSON."""
    return {
        "title": study.title,
        "answer": study.answer,
        "ok": study.ok,
        "checks": [finding.data() for finding in study.findings],
        "sources": study.sources,
        "figures": [figure.data() for figure in study.figures],
    }


def composing(title: str, theory: str, telling: Mapping[str, tuple[int, int]]) -> Compose:
    """What makes the report of its JSON.

    Args:
        title: Title of the report.
        theory: Page of docs/ that it rests on.
        telling: Study -> figure and chart that the index of reports shows.
    """

    def compose(data: Data) -> Report:
        studies, failures = data["studies"], data.get("failures", {})
        findings = {key: [Finding.of(check) for check in study["checks"]] for key, study in studies.items()}
        every = [finding for group in findings.values() for finding in group]
        verdict = bounds_kept(every) + (f"; {counted(len(failures), 'study')} could not be done" if failures else "")
        short_way = " (quick variant: fewer points, shorter motions)" if data.get("quick") else ""
        missed = [study["title"] for study in studies.values() if not study["ok"]]
        intro: tuple[Block, ...] = (
            "Each section asks a question, answers it from what this run measured, shows it, and lists the numbers "
            f"with the bounds they must keep. The theory is in `{theory}`.",
            *failure_texts(failures),
        )
        highlights = [
            Chart.of(studies[key]["figures"][figure]["charts"][chart])
            for key, (figure, chart) in telling.items()
            if key in studies and studies[key]["figures"]
        ]
        return Report(
            title,
            f"{counted(len(every), 'number')} on {counted(len(studies), 'question')}: {verdict}{short_way}.",
            bool(data["ok"]),
            intro,
            tuple(_section(key, study, findings[key]) for key, study in studies.items()),
            (
                Fact(str(len(studies)), "questions answered"),
                Fact(str(len(every)), f"numbers, {bounds_kept(every)}", bool(data["ok"])),
                *(Fact("missed", question, False) for question in missed),
            ),
            tuple(highlights),
            (findings_digest(findings, failures, "study"),),
            tuple(data.get("unfinished", ())),
        )

    return compose


def _section(name: str, study: Data, findings: list[Finding]) -> Section:
    sources = "; ".join(study["sources"])
    blocks: list[Block] = [study["answer"], *map(Figure.of, study["figures"]), findings_fold(findings, "number")]
    blocks += [Text(f"Reference numbers: {sources}.", "soft")] if sources else []
    return Section(study["title"], tuple(blocks), name, bool(study["ok"]))
