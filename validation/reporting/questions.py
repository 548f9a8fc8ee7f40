"""A report of questions: studies are asked one by one; each answers in words, figures, and numbers with bounds."""

# Annotations are values here: the options of a command name its studies.
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Annotated, Any

import typer

from .command import Quick, Run, known
from .findings import Finding, Question, Study
from .numbers import counted, short
from .plain import plain, restored
from .record import Block, Compose, Data, Fact, Report, Section, Table, Text, verdict

# Where a sentence ends and another begins.
_SENTENCE = re.compile(r"(?<=[.?!])\s+(?=[A-Z])")


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
        return done.head(ok, quick) | {"studies": {name: data_of(study) for name, study in done.results.items()}}

    measure.__doc__ = doc
    return measure


def data_of(study: Study) -> dict[str, Any]:
    """A study for JSON."""
    return {**plain(study), "ok": study.ok}


def composing(title: str, theory: str) -> Compose:
    """A function that composes the report from its data; `theory` is the page of docs/ that it rests on."""
    intro = (
        "Each section asks a question, answers it from what this run measured, shows it, and lists the numbers with "
        f"the bounds they must keep. The theory is in `{theory}`."
    )

    def compose(data: Data) -> Report:
        studies = {name: restored(Study, study) for name, study in data["studies"].items()}
        missed = (Fact("missed", study.title, False) for study in studies.values() if not study.ok)
        sections = tuple(_section(name, study) for name, study in studies.items())
        facts = (Fact(str(len(studies)), "questions answered"), *missed)
        answers = answers_in_short((name, study.title, study.answer) for name, study in studies.items())
        on = f"on {counted(len(studies), 'question')}"
        draft = Report(title, on, None, (intro,), sections, facts=facts, decisions=answers)
        return judged(draft, data, {name: study.findings for name, study in studies.items()}, "study", "number")

    return compose


def answers_in_short(asked: Iterable[tuple[str, str, str]], head: str = "answer in short") -> tuple[Table, ...]:
    """Of anchors, questions and texts, a table of each question with the first sentence of its text, under `head`."""
    rows = [(f"[{question}](#{anchor})", _SENTENCE.split(text)[0]) for anchor, question, text in asked]
    return (Table.of(f"question | {head}", rows),) if rows else ()


def _section(name: str, study: Study) -> Section:
    sources = (Text(f"Reference numbers: {'; '.join(study.sources)}.", "soft"),) if study.sources else ()
    blocks = (study.answer, *study.figures, findings_fold(study.findings, "number"), *sources)
    return Section(study.title, blocks, name, study.ok)


def judged(draft: Report, data: Data, findings: Mapping[str, Sequence[Finding]], part: str, number: str) -> Report:
    """A draft of a report whose parts state numbers with bounds, with its verdict.

    Args:
        draft: Report whose summary says of what the numbers are.
        data: JSON of the report, with what `Done.head` states.
        findings: Part -> its numbers.
        part: What a part is called.
        number: What a number is called.
    """
    rows = [(name, finding) for name, group in findings.items() for finding in group]
    missed = tuple(f"{name}: {one.quantity} is {one.bounds}" for name, one in rows if not one.ok)
    failures, unfinished = data.get("failures", {}), tuple(data.get("unfinished", ()))
    kept = f"{len(missed)} miss their bounds" if missed else "all within their bounds"
    failed = f"; {counted(len(failures), part)} could not be done" if failures else ""
    quick = " (quick variant: fewer points, shorter motions)" if data.get("quick") else ""
    cut = f" Interrupted: {', '.join(unfinished)} not done." if unfinished else ""
    ok, reasons = bool(data["ok"]), failure_texts(failures)
    return replace(
        draft,
        summary=f"{counted(len(rows), number)} {draft.summary}: {kept}{failed}{quick}.{cut}",
        ok=ok,
        blocks=(*draft.blocks, *reasons),
        facts=(*draft.facts, Fact(str(len(rows)), f"{number}s, {kept}", ok)),
        digest=(Table.of(f"{part} | {_BOUNDS}", ((name, *_bounds(finding)) for name, finding in rows)), *reasons),
        unfinished=unfinished,
        missed=missed,
    )


_BOUNDS = "number | found | at least | at most"


def _bounds(finding: Finding) -> tuple[str, ...]:
    """A number beside its bounds, for a table."""
    return finding.quantity, verdict(short(finding.value), finding.ok), short(finding.low), short(finding.high)


def findings_fold(findings: Sequence[Finding], noun: str, more: str = "", *blocks: Block) -> Section:
    """The numbers, called `noun`, and blocks that the title names by `more`; open where one misses its bounds."""
    missed = sum(not finding.ok for finding in findings)
    said = f"{counted(len(findings), noun)} and their bounds" + (f": **{missed} missed**" if missed else "") + more
    table = Table.of(f"{_BOUNDS} | reason of the bound", ((*_bounds(finding), finding.reason) for finding in findings))
    return Section(said, (table, *blocks), ok=not missed)


def failure_texts(failures: Mapping[str, str]) -> tuple[Text, ...]:
    """The parts that could not be done, with their reasons."""
    return tuple(Text(f"{name} could not be done: {reason}", "bad") for name, reason in failures.items())
