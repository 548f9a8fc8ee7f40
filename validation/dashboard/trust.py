"""Entries -> trust.html: may I trust this for my robot? All of it from the JSON of the stored reports."""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from statistics import median

import symofros as sf

from ..checking import description_hash
from ..comparison.errors import Comparison
from ..cross_check.record import Record as Checked
from ..cross_check.record import is_independent
from ..cross_check.tables import worst
from ..engines.parts import CELLS, unnested
from ..engines.verdicts import RED
from ..inputs.cases import Case, standard_set
from ..reporting.numbers import counted, digits, times
from ..reporting.plain import restored
from ..reporting.record import Block, Bullets, Data, Report, Search, Section, Table, Text
from ..timing.record import Entry as Race
from ..timing.record import Record as Timed
from .gather import Entry

# File suffix -> format; our own YAML and Python otherwise.
_FORMATS = {".urdf": "URDF", ".xml": "MJCF", ".sdf": "SDF", ".usda": "USD"}
# Kinds of constraints -> what people call them.
_LOOPS = {
    "Closure": "closed loop",
    "Rod": "loop closed by a massless rod",
    "Coupling": "coupling of coordinates",
    "Rolling": "rolling without slip",
    "KnifeEdge": "knife edge",
}


@dataclass(frozen=True)
class Features:
    """What a description has.

    Attributes:
        joints: Kinds of its joints, the most frequent first.
        parts: What else it has, with its number: closed loops, beams, springs and contacts.
        format: Format of its file; "YAML or Python" for ours.
    """

    joints: tuple[str, ...]
    parts: tuple[str, ...]
    format: str

    @property
    def said(self) -> str:
        """All of it in words."""
        return "; ".join(filter(None, (", ".join(self.parts), f"joints: {', '.join(self.joints)}", self.format)))


def features_of(hashes: Mapping[str, str]) -> dict[str, Features]:
    """What the models of a stored check have; only those that are here as they were compared.

    Args:
        hashes: Model -> hash of the description that was compared.
    """
    return {case.label: found for case, found in _read(hashes)}


def _read(hashes: Mapping[str, str]) -> Iterator[tuple[Case, Features]]:
    try:
        cases = standard_set()
    except FileNotFoundError:  # The package of robots is not installed.
        return
    for case in cases:
        if case.label not in hashes:
            continue
        try:
            system = case.load().system
        except (sf.SymofrosError, OSError):
            continue
        if description_hash(system) == hashes[case.label]:
            yield case, _features(system, case)


def _features(system: sf.System, case: Case) -> Features:
    kinds = Counter(body.joint.kind for body in system.bodies if body.joint is not None)
    counts = Counter(_LOOPS.get(type(one).__name__, type(one).__name__.lower()) for one in system.constraints)
    counts["beam"] = len(system.beams)
    counts |= Counter("contact" if isinstance(one, sf.Contact) else "spring or damper" for one in system.connections)
    parts = tuple(f"{number} {name}{'s' * (number > 1)}" for name, number in counts.items() if number)
    suffix = case.path.suffix if case.path else ""
    return Features(tuple(kind for kind, _ in kinds.most_common()), parts, _FORMATS.get(suffix, "YAML or Python"))


TITLE = "May I trust this for my robot?"
# Name of ours among the engines.
_OURS = "symofros"
_EXAMPLES = ("beam", "closed loop", "universal", "urdf mimic", "mujoco", "talos")
_SEARCH = "what is in it | agrees with | digits, median | digits, at least | faster than".split(" | ")
_HOW_TO_READ = """Rows are whole models, which are compared with other engines at random states, then trees and files
of a few bodies, whose right answers are known to thirty digits. Digits are those of the median and of the worst of all
quantities, relative to the largest entry; few agree where an engine differentiates by small steps, or solves with a
heavy robot's light fingers."""
_DIGITS = 16.0


def trust(entries: Mapping[str, Entry]) -> Report:
    """The page: five questions with short answers, what can be looked for, then each answer in full."""
    data = {name: entry.data for name, entry in entries.items() if entry.report}
    checked = Checked.of(data["check"]) if "check" in data else None
    raced = restored(Timed, data["timing"]).fastest() if "timing" in data else []
    features = features_of({model.label: model.hash for model in checked.models}) if checked else {}
    cells = unnested(data["engines"]["cells"], CELLS) if "engines" in data else []
    answers = (
        ("**What is covered?**", _covered(checked, features, cells), "check"),
        ("**Who agrees, to how many digits?**", _agreed(checked), "check"),
        ("**How fast is it?**", _fast(raced), "timing"),
        ("**Where does it fail?**", _fails(entries), "stability"),
        ("**What is not covered?**", uncovered(entries), "check"),
    )
    rows = tuple((asked, said, f"[{name}]({name}.html)") for asked, said, name in answers if said)
    found = [*_models(checked, features, raced), *_trees(cells)]
    wrong = [name for name, entry in entries.items() if entry.verdict == "wrong"]
    return Report(
        TITLE,
        f"Look twice: {', '.join(wrong)} found something wrong." if wrong else _headline(checked),
        not wrong if checked else None,
        (Table.of("question | answer | in full", rows),),
        (
            Section("Look for a joint, a loop, a beam, a format, an engine", _searched(found), "search"),
            Section("Engine by engine", _engines(checked), "engines"),
            Section("Where it fails, and what to do instead", tuple(_failures(entries)), "fails"),
            Section("What is not covered", tuple(_gaps(checked)), "gaps"),
        ),
    )


def _headline(checked: Checked | None) -> str:
    if checked is None:
        return "The cross-check has not been made."
    rows = _independent(checked)
    judged = {row.model for row in rows}
    # Several routes lead to one engine: by its own reader, its loops, its beams.
    engines = sorted({row.engine.partition("-")[0] for row in rows})
    return (
        f"As far as it goes: {len(judged)} of {counted(len(checked.models), 'model')} agree with each independent "
        + (f"engine that can represent them ({', '.join(engines)}); look for yours below.")
    )


def _independent(checked: Checked) -> list[Comparison]:
    return [row for row in checked.compared if is_independent(row.engine)]


def _covered(checked: Checked | None, features: Mapping[str, Features], cells: Sequence[Data]) -> str:
    if checked is None:
        return ""
    speeds = [model.sizes["nv"] for model in checked.models if "nv" in model.sizes]
    having = Counter(word for one in features.values() for word in _words(one))
    loops, beams = having["loop"], having["beam"]
    kinds = sorted({kind for one in features.values() for kind in one.joints})
    formats = sorted({one.format for one in features.values()})
    trees = len({cell["model"] for cell in cells if cell["engine"] == _OURS})
    said = f"{counted(len(checked.models), 'model')} of {min(speeds)} to {max(speeds)} speeds"
    said += f", {loops} with closed loops, {beams} with flexible beams" if features else ""
    said += f"; joints: {', '.join(kinds)}; read from {', '.join(formats)}" if features else ""
    return said + (f"; {trees} more trees and files, each with an answer to thirty digits." if trees else ".")


def _words(one: Features) -> Iterator[str]:
    yield from (word for word in ("loop", "beam") if any(word in part for part in one.parts))


def _agreed(checked: Checked | None) -> str:
    if checked is None or not (rows := _independent(checked)):
        return ""
    wrong = [row for row in rows if not row.ok]
    near = worst(rows)
    middle = median(_digits(row) for row in rows)
    said = f"{len(rows) - len(wrong)} of {counted(len(rows), 'comparison')} with independent engines agree"
    said += f" ({', '.join(dict.fromkeys(row.engine for row in rows))})"
    said += f", half of them to {middle:.1f} digits or more"
    if near is not None:
        said += (
            f"; nearest to its bound is {near.title} of {near.model}, {digits(near.error)} of {digits(near.tolerance)}"
        )
    return f"{said}."


def _digits(row: Comparison) -> float:
    return 0.0 if row.error is None else _DIGITS if row.error == 0.0 else min(_DIGITS, -math.log10(row.error))


def _fast(raced: Sequence[Race]) -> str:
    if not raced:
        return ""
    groups: dict[str, list[float]] = defaultdict(list)
    for row in raced:
        groups[row.peer].append(row.ratio)
    medians = ", ".join(f"{times(median(group))} as fast as {peer}" for peer, group in groups.items())
    return f"Faster than the peer in {sum(row.ratio > 1.0 for row in raced)} of {counted(len(raced), 'race')}; " + (
        f"in the median {medians}."
    )


def _fails(entries: Mapping[str, Entry]) -> str:
    """In short: how many studies there are of it, and which of our own targets are missed."""
    said = []
    for name, noun in (("stability", "study"), ("accuracy", "question")):
        if studies := entries[name].data.get("studies") if entries[name].report else None:
            said.append(f"{counted(len(studies), noun)} on {_ABOUT[name]} ([{name}]({name}.html))")
    missed = {name: len(entry.report.missed) for name, entry in entries.items() if entry.report and entry.report.missed}
    short = ", ".join(f"{name} {number}" for name, number in missed.items())
    short = f" Targets that are missed: {short}." if short else ""
    return (f"There are limits, and they are measured: {', '.join(said)}; [in short](#fails)." if said else "") + short


_ABOUT = {
    "stability": "steps, gains, masses and postures at which simulations fail",
    "accuracy": "how far beams may bend",
}


_SCOPE = """Not meant for collision of meshes or of many bodies, for plates, shells and solids that deform, for flexible
bodies from finite elements (`docs/comparison.md` names what is)."""


def uncovered(entries: Mapping[str, Entry]) -> str:
    """What is out of scope, and what the cross-check leaves open, in short."""
    if "check" not in entries or not entries["check"].report:
        return ""
    checked = Checked.of(entries["check"].data)
    alone, own = _unjudged(checked), _own_quantities(checked)
    said = f"{_SCOPE} {counted(len(own), 'quantity')} only our own routes and formulas judge"
    models = f"no engine judges {', '.join(alone)}" if alone else "each model is judged by an engine"
    refused = len({(row.model, row.engine) for row in checked.rows("unsupported") if is_independent(row.engine)})
    pairs = f"in {counted(refused, 'pair')} of model and engine the engine can't say everything"
    return f"{said}; {models}; {pairs} ([in full](trust.html#gaps))."


def _unjudged(checked: Checked) -> list[str]:
    judged = {row.model for row in _independent(checked)}
    return [model.label for model in checked.models if model.label not in judged]


def _own_quantities(checked: Checked) -> list[str]:
    """Quantities that only our own routes compare."""
    judged = {row.quantity for row in _independent(checked)}
    return [name for name in dict.fromkeys(row.quantity for row in checked.compared) if name not in judged]


def _engines(checked: Checked | None) -> tuple[Block, ...]:
    groups: dict[str, list[Comparison]] = defaultdict(list)
    for row in _independent(checked) if checked else ():
        groups[row.engine].append(row)
    lines = (
        (
            name,
            str(len({row.model for row in rows})),
            str(len(rows)),
            str(sum(not row.ok for row in rows)),
            f"{median(map(_digits, rows)):.1f}",
            f"{min(map(_digits, rows)):.1f}",
        )
        for name, rows in groups.items()
    )
    head = "engine | models | comparisons | disagree | digits, median | digits, at least"
    return (Table.of(head, lines),)


def _failures(entries: Mapping[str, Entry]) -> Iterator[Block]:
    """Each study of stability with its verdict, each question on beams with its answer, each target that is missed."""
    sections = {name: entry.report.sections for name, entry in entries.items() if entry.report}
    for name, key in (("stability", "verdict"), ("accuracy", "answer")):
        studies = entries[name].data.get("studies", {}) if name in sections else {}
        titles = {section.anchor: section.title for section in sections.get(name, ())}
        lines = ((f"[{titles[one]}]({name}.html#{one})", said[key]) for one, said in studies.items() if one in titles)
        yield Table.of("question | what was found", lines)
    missed = ((name, line) for name, entry in entries.items() if entry.report for line in entry.report.missed)
    yield Table.of("report | what is missed", missed)


def _gaps(checked: Checked | None) -> Iterator[Block]:
    if checked is None:
        return
    refused: dict[tuple[str, str], list[str]] = defaultdict(list)
    for row in checked.rows("unsupported"):
        if is_independent(row.engine):
            refused[row.engine, row.note].append(row.model)
    if alone := _unjudged(checked):
        yield Text(f"No independent engine judges {', '.join(alone)}.", "bad")
    lines = ((engine, ", ".join(dict.fromkeys(models)), note) for (engine, note), models in refused.items())
    yield Table.of("engine | has no say on | because", lines)
    yield Section("What only our own formulas and routes judge", (Bullets(tuple(_own_quantities(checked))),))


def _searched(found: Sequence[tuple[str, ...]]) -> tuple[Block, ...]:
    return (Search(Table(("model", *_SEARCH), tuple(found)), _EXAMPLES), Text(_HOW_TO_READ, "soft")) if found else ()


def _models(
    checked: Checked | None, features: Mapping[str, Features], raced: Iterable[Race]
) -> Iterator[tuple[str, ...]]:
    """A row a model of the cross-check."""
    faster: dict[str, dict[str, list[float]]] = defaultdict(lambda: defaultdict(list))
    for race in raced:
        faster[race.model][race.peer].append(race.ratio)
    for model in checked.models if checked else ():
        rows = [row for row in model.compared if is_independent(row.engine)]
        wrong = {row.engine for row in rows if not row.ok}
        engines = [f"**not {row.engine}**" if row.engine in wrong else row.engine for row in rows]
        size = ", ".join(f"{model.sizes[name]} {word}" for name, word in _SIZES.items() if name in model.sizes)
        said = "; ".join(filter(None, (features[model.label].said if model.label in features else "", size)))
        speeds = ", ".join(f"{peer} {times(median(group))}" for peer, group in faster[model.label].items())
        least = min(rows, key=_digits, default=None)
        digits_of = ("-", "-") if least is None else (f"{median(map(_digits, rows)):.1f}", _least(least))
        yield model.label, said, ", ".join(dict.fromkeys(engines)) or "no engine", *digits_of, speeds or "not raced"


_SIZES = {"bodies": "bodies", "nv": "speeds"}


def _least(row: Comparison) -> str:
    """Digits of a comparison, with what is compared, and its bound where that is what asks for so few."""
    return f"{_digits(row):.1f} in {row.title}, {row.engine}"


def _trees(cells: Iterable[Data]) -> Iterator[tuple[str, ...]]:
    """A row a tree or file of the comparison of engines with answers to thirty digits."""
    by_tree: dict[str, list[Data]] = defaultdict(list)
    for cell in cells:
        by_tree[cell["model"]].append(cell)
    for tree, asked in by_tree.items():
        own = [cell for cell in asked if cell["engine"] == _OURS]
        if not own:
            continue
        red = dict.fromkeys(cell["engine"] for cell in asked if cell["verdict"] in RED)
        right = dict.fromkeys(cell["engine"] for cell in asked if cell["engine"] not in red and cell["engine"] != _OURS)
        good = [cell for cell in own if cell["verdict"] == "right"]
        said = f"{len(good)} of {counted(len(own), 'function')} of ours right"
        agreed = ", ".join(right) + (f"; red in {', '.join(red)}" if red else "")
        each = [min(_DIGITS, -math.log10(cell["error"])) if cell["error"] else _DIGITS for cell in good]
        yield tree, said, agreed, *(f"{of(each):.1f}" if each else "-" for of in (median, min)), ""
