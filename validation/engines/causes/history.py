"""Which releases have a cause: the shortest script that proves it, run in environments of other releases."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ...faults.environment import NotAskedError, day_of, default_folder, kept, own_variables, published
from .. import parts
from ..bisection import Search, red_place, span_lines
from ..proving.scripts import exception_of, fails
from ..releases import stated
from .cause import FOLDER, Cause
from .cause import stated as causes
from .grouping import causes_of
from .shown import scripts_of


@dataclass(frozen=True)
class Proof:
    """A script of an engine alone that fails where a release has a cause.

    Attributes:
        version: The release that it is known to fail with.
        text: The script.
        exception: Type of the exception that it ends in; "" for its assertion or a crash.
        words: Pattern of what it says then.
    """

    version: str
    text: str
    exception: str = ""
    words: str = ""

    def shown_by(self, python: Path) -> bool | str:
        """Whether the release of an environment has the cause, or in words why that can't be said."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "script.py"
            path.write_text(self.text, encoding="utf-8")
            output, failed = fails(path, self.exception, str(python), own_variables())
        *said, ending = output.splitlines()
        if failed:
            return re.search(self.words, output) is not None or "another " + said[-1]
        return ending != "exit code 0" and (said or [ending])[-1]


def named(names: Sequence[str]) -> list[Cause]:
    """The causes that ENGINE/CAUSE name, and of an engine alone those whose releases are not known.

    Raises:
        ValueError: There is no such cause.
    """
    found = []
    for name in names:
        engine, _, rest = name.partition("/")
        own = [one for one in causes() if one.engine == engine and (one.name == rest if rest else not one.first)]
        if not own and rest:
            known = ", ".join(f"'{one.engine}/{one.name}'" for one in causes() if one.engine == engine)
            raise ValueError(f"no cause '{name}'; there are {known or 'none of this engine'}")
        found += own
    return found


def proof_of(cause: Cause, data: Mapping[str, Any]) -> Proof:
    """The shortest script of a cause in a stored report.

    Raises:
        ValueError: The report has none.
    """
    groups = causes_of(parts.cells(data), corrected=parts.cells(data, "corrected"))
    own = [group for group in groups if group.cause == cause]
    scripts = [script for group in own for script in scripts_of(group, groups, data["proofs"])]
    if not scripts:
        raise ValueError(f"{cause.engine}/{cause.name}: the stored report has no script that proves it")
    first = scripts[0]
    (version,) = (one["version"] for one in data["engines"] if one["name"] == cause.engine)
    place = first["function"], first["model"]
    (cell,) = (one for group in own for one in group.cells if (one.function, one.model) == place)
    return Proof(version, first["text"], exception_of(cell), cause.words)


def histories(
    chosen: Sequence[Cause], data: Mapping[str, Any], requires: Sequence[str], folder: Path | None
) -> Iterator[str]:
    """Lines that say which releases have causes; what is found is stored in the causes' files.

    Args:
        chosen: The causes.
        data: A stored report, whose scripts are run.
        requires: Further requirements of the environments.
        folder: Folder of the environments; None: in the cache folder.

    Raises:
        NotAskedError: The releases of an engine can't be listed.
    """
    place = folder or default_folder()
    for cause in chosen:
        yield f"{cause.engine}/{cause.name}"
        try:
            yield from _history(cause, proof_of(cause, data), requires, place)
        except (NotAskedError, ValueError) as error:
            yield str(error)


def _history(cause: Cause, proof: Proof, requires: Sequence[str], folder: Path) -> Iterator[str]:
    """The lines of one cause."""
    ((_, release),) = stated(cause.engine, requires)[:1]

    def ask(version: str) -> bool | str:
        wanted = replace(release, version=version).requirements
        try:  # Beside what there was when it was published: it was made for that.
            return proof.shown_by(kept(folder, wanted, day_of(wanted[0])))
        except NotAskedError as error:
            return str(error)

    search = Search(published(release.package), ask)
    bad = red_place(search, proof.version, release.package)
    span = search.span(bad)
    yield from span_lines(search, span, release.package)
    store(cause, span.first if span.before else f"{span.first} or before", span.last if span.good else "")


def store(cause: Cause, first: str, last: str, folder: Path = FOLDER) -> None:
    """State the first and the last release of a cause in its file; nothing else of it changes."""
    path = folder / f"{cause.engine}.yaml"
    blocks = re.split(r"(?m)^(?=- name: )", path.read_text(encoding="utf-8"))
    for k, block in enumerate(blocks):
        if block.splitlines()[:1] == [f"- name: {cause.name}"]:
            kept_lines = re.sub(r"(?m)^  (first|last): .*\n", "", block)
            own = f'  first: "{first}"\n' + (f'  last: "{last}"\n' if last else "")
            blocks[k] = kept_lines + own
    path.write_text("".join(blocks), encoding="utf-8")
