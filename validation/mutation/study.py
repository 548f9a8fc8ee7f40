"""Faults in the source before two judges, `check` and the tests, one fault at a time."""

from __future__ import annotations

import hashlib
import json
import signal
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import Any

import symofros as sf
from symofros.tools import append_line, stored_lines

from .fault import SourceFault
from .fresh import Fresh
from .overlay import Overlay
from .sampling import drawn
from .tests_judge import HUNG, chosen


class Store:
    """Answers of judges by fault and stage.

    Args:
        path: File of JSON lines; made when the first answer comes.
        root: Folder of the sources: answers about a file that has changed since are left out.
    """

    def __init__(self, path: Path, root: Path) -> None:
        self.path, self.root = path, root
        self._digests: dict[str, str] = {}
        self._answers: dict[tuple[str, str], dict[str, Any]] = {}
        for row in stored_lines(path, _row):
            if not row["module"] or row["digest"] == self.digest(row["module"]):
                self._answers[row["id"], row["stage"]] = row["answer"]

    def digest(self, module: str) -> str:
        """Digest of a module's text; "" for one that is gone."""
        if module not in self._digests:
            file = self.root / module
            text = file.read_bytes() if file.is_file() else b""
            self._digests[module] = hashlib.sha256(text).hexdigest()[:16] if text else ""
        return self._digests[module]

    def get(self, id: str, stage: str) -> dict[str, Any] | None:
        """The answer of a stage; None if it is not known."""
        return self._answers.get((id, stage))

    def put(self, id: str, stage: str, answer: dict[str, Any], module: str = "") -> None:
        """Keep an answer."""
        self._answers[id, stage] = answer
        digest = self.digest(module) if module else ""
        row = {"id": id, "stage": stage, "module": module, "digest": digest, "answer": answer}
        append_line(self.path, row)


def _row(line: Any) -> dict[str, Any]:
    """A line of the store, each value of its type."""
    texts = {name: str(line[name]) for name in ("id", "stage", "module", "digest")}
    return {**texts, "answer": dict(line["answer"])}


CHECK, OUTPUTS, TESTS, LONGER, SOUND = "check", "outputs", "tests", "tests with more time", "sound"
# Fates of a fault. "stillborn": the C compiler refuses it, so that nobody could use it; "halted": check, or a test,
# does not end, which is seen by whoever runs it, but is no verdict; "argued": looked at by a person.
STILLBORN, CAUGHT, UNCHANGED, SURVIVED, OPEN = "stillborn", "caught", "no result changed", "survived", "open"
HALTED, ARGUED = "halted", "argued"
# Processor times [s].
CHECK_LIMIT, OUTPUTS_LIMIT, TESTS_LIMIT, SOUND_LIMIT = 90.0, 120.0, 90.0, 600.0
LONGER_LIMIT = 300.0
SAMPLE = 4  # One fault in so many goes to `check` first.
TESTS_BUDGET = 15.0  # Processor time after which no further test of a fault begins [s].
LONGER_BUDGET = 120.0  # The same where nobody has seen a fault, and tests were left [s].
# Ends of a process that are its own doing. `check` reports them as a failed row, a run of the tests fails. Not among
# them: SIGKILL and SIGBUS, which lack of memory or disk space brings, too; SIGBUS twice is no accident.
_CRASHES = {-signal.SIGSEGV, -signal.SIGABRT, -signal.SIGFPE, -signal.SIGILL}
# What the outputs that are compared do not come from: a fault there that no test sees counts as survived until argued.
BEYOND = ("symofros/exports/", "symofros/interop/", "symofros/runtime/cuda/")
_ARGUED = Path(__file__).with_name("argued.json")
_CHECK_JUDGE, _TESTS_JUDGE = "validation.mutation.check_judge", "validation.mutation.tests_judge"
_OUTPUTS = "validation.mutation.outputs"

_ROOT = Path(__file__).parents[2]

Report = Callable[[str], None]
Answer = dict[str, Any]


def argued_faults(file: Path = _ARGUED) -> dict[str, str]:
    """Fault -> a person's argument that it changes no result.

    Args:
        file: JSON of them.

    Raises:
        SymofrosError: A fault is of a module that does not exist.
    """
    argued: dict[str, str] = json.loads(file.read_text(encoding="utf-8"))
    gone = [fault for fault in argued if not (_ROOT / fault.partition(":")[0]).is_file()]
    if gone:
        rule = "an argued fault is one of a module that there is"
        raise sf.SymofrosError(
            f"{file.name}: no such module", "; ".join(gone), rule, "name the present one, or remove the fault"
        )
    return argued


@dataclass
class Study:
    """The faults of one draw, and what is known of them.

    Attributes:
        faults: The faults.
        store: Answers.
        overlay: The copy that they are planted in.
        folder: Folder of copy, answers, outputs of the sound package.
        report: Told what was done.
        failing: Tests that fail without a fault.
        argued: Fault -> why it changes no result, or what is changed is none; looked at by a person.
    """

    faults: tuple[SourceFault, ...]
    store: Store
    overlay: Overlay
    folder: Path
    report: Report
    failing: set[str] = field(default_factory=set)
    argued: dict[str, str] = field(default_factory=lambda: argued_faults())

    @classmethod
    def begun(
        cls, root: Path, folder: Path, count: int, seed: int, cache: Path | None, report: Report, since: str = ""
    ) -> Study:
        """A new study, or that which is in the folder: the copy of the tree there is the one that it goes on with.

        Args:
            root: Folder of the repository.
            folder: Folder of the study.
            count: Number of faults.
            seed: Seed of the draw.
            cache: Folder of models that are compiled already.
            report: Told what was done.
            since: Revision or day: only code that is new since then; all if empty.

        Raises:
            LookupError: There is no such revision.
        """
        fresh = Fresh(root, since) if since else None
        overlay = Overlay(root, folder, cache)
        faults = tuple(islice(drawn(overlay.tree, seed, fresh), count))
        return cls(faults, Store(folder / "answers.jsonl", overlay.tree), overlay, folder, report)

    def run(self, seconds: float) -> None:
        """Ask the judges about every fault that they have not answered yet, one fault after the other.

        Its tests are asked first, which is cheap; what they do not see goes to `check`. Of one fault in SAMPLE it is
        the other way round, so that these give the score of `check` alone, and at the end the tests are asked about
        what it sees of them, for a score of their own. What neither sees is compared with the sound package's outputs.
        Tests whose time was over are given more in the end, those of faults that are known to change a result first.

        Args:
            seconds: Time after which no further fault is begun [s].

        Raises:
            RuntimeError: The sound package does not pass.
        """
        end = time.monotonic() + seconds
        self._require_sound()
        for fault in self.faults:
            if time.monotonic() > end:
                return
            if fault.id not in self.argued:
                self._settle(fault)
        for fault in self.faults:
            if time.monotonic() > end:
                return
            check = self.store.get(fault.id, CHECK)
            if self.sampled(fault) and seen(check) and not stillborn(fault, check):
                self._asked(fault, TESTS, self._test)
        still_open = [fault for fault in self.faults if self.fate(fault) == OPEN]
        for fault in sorted(still_open, key=lambda one: unchanged(self.store.get(one.id, OUTPUTS))):
            if time.monotonic() > end:
                return
            self._asked(fault, LONGER, lambda one: self._test(one, LONGER_BUDGET, LONGER_LIMIT))

    def sampled(self, fault: SourceFault) -> bool:
        """Whether `check` is asked about a fault before its tests are."""
        return self.faults.index(fault) % SAMPLE == 0

    def _settle(self, fault: SourceFault) -> None:
        """Ask about one fault until a judge sees it, or none does."""
        judges = ((CHECK, self._check), (TESTS, self._test))
        for stage, ask in judges if self.sampled(fault) else judges[::-1]:
            answer = self._asked(fault, stage, ask)
            if seen(answer) or (stage == CHECK and halted(answer)):
                return
        self._asked(fault, OUTPUTS, self._compare)

    def _asked(self, fault: SourceFault, stage: str, ask: Callable[[SourceFault], Answer]) -> Answer:
        """The answer of a judge, which is kept."""
        answer = self.store.get(fault.id, stage)
        if answer is not None:
            return answer
        with self.overlay.planted(fault):
            answer = ask(fault)
        if stage in (TESTS, LONGER) and seen(answer) and self._fails_without(answer):
            return self._asked(fault, stage, ask)
        self.store.put(fault.id, stage, answer, fault.module)
        self.report(f"{stage}: {fault.module}")
        return answer

    def _fails_without(self, answer: Answer) -> bool:
        """Whether the test that failed fails on the sound package, too: it is left out from then on."""
        test = (answer["answer"] or {}).get("test", "")
        if "::" not in test:
            return False
        if self.store.get(test, SOUND) is None:
            asked = {"files": [test], "deselected": [], "budget": TESTS_BUDGET}
            self.store.put(test, SOUND, self.overlay.ask(_TESTS_JUDGE, "judge", TESTS_LIMIT, **asked))
        if not seen(self.store.get(test, SOUND)):
            return False
        self.failing.add(test)
        return True

    def _require_sound(self) -> None:
        """Require that `check` passes without a fault, and that outputs are the same when they are computed again."""
        for module in ("symofros/mechanics/beams/fields.py", "symofros/generator/units.py"):
            answer = self.overlay.ask(_CHECK_JUDGE, "judge", SOUND_LIMIT, module=module)
            if (answer["answer"] or {}).get("status") != "passed":
                raise RuntimeError(f"check does not pass without a fault: {answer}; see {self.overlay.log}")
        path = self.folder / "outputs.npz"
        if not path.exists():
            self.overlay.ask(_OUTPUTS, "record", SOUND_LIMIT, path=str(path))
            answer = self.overlay.ask(_OUTPUTS, "compare", SOUND_LIMIT, path=str(path))
            if (answer["answer"] or {}).get("status") != "same bits":
                path.unlink(missing_ok=True)
                raise RuntimeError(f"the sound package differs from itself: {answer}; see {self.overlay.log}")

    def _check(self, fault: SourceFault) -> Answer:
        return self.overlay.ask(_CHECK_JUDGE, "judge", CHECK_LIMIT, module=fault.module)

    def _compare(self, fault: SourceFault) -> Answer:
        return self.overlay.ask(_OUTPUTS, "compare", OUTPUTS_LIMIT, path=str(self.folder / "outputs.npz"))

    def _test(self, fault: SourceFault, budget: float = TESTS_BUDGET, limit: float = TESTS_LIMIT) -> Answer:
        files = chosen(self.overlay.tree, fault.module)
        asked = {"files": files, "deselected": sorted(self.failing), "budget": budget}
        return self.overlay.ask(_TESTS_JUDGE, "judge", limit, **asked)

    def tested(self, fault: SourceFault) -> Answer | None:
        """The last answer of the tests."""
        return self.store.get(fault.id, LONGER) or self.store.get(fault.id, TESTS)

    def _crashes_again(self, fault: SourceFault) -> bool:
        """Whether the tests ended by SIGBUS both times that they were asked."""
        answers = (self.store.get(fault.id, stage) for stage in (TESTS, LONGER))
        return all(answer is not None and answer.get("code") == -signal.SIGBUS for answer in answers)

    def fate(self, fault: SourceFault) -> str:
        """The fate of a fault by the answers known so far."""
        check, tests = self.store.get(fault.id, CHECK), self.tested(fault)
        outputs = self.store.get(fault.id, OUTPUTS)
        if stillborn(fault, check) or stillborn(fault, outputs):
            return STILLBORN
        if seen(check) or seen(tests) or self._crashes_again(fault):
            return CAUGHT
        if halted(check) or hung(tests):
            return HALTED
        if fault.id in self.argued:
            return ARGUED
        if check is None or tests is None or outputs is None or not (tests["answer"] or {}).get("whole"):
            return OPEN  # Tests that ran out of time have said nothing.
        return UNCHANGED if unchanged(outputs) and not fault.module.startswith(BEYOND) else SURVIVED


def stillborn(fault: SourceFault, answer: Answer | None) -> bool:
    """Whether a fault in C is none that compiles."""
    reason = str(((answer or {}).get("answer") or {}).get("reason", ""))
    return not fault.module.endswith(".py") and "CompileError" in reason


def unchanged(answer: Answer | None) -> bool:
    """Whether the outputs are those of the sound package, but for rounding."""
    return ((answer or {}).get("answer") or {}).get("status") in ("same bits", "other text", "rounding")


def seen(answer: Answer | None) -> bool:
    """Whether `check` or a test failed, or crashed; one that does not end has seen nothing."""
    said = (answer or {}).get("answer") or {}
    return bool(said.get("status", "passed") != "passed") or crashed(answer)


def crashed(answer: Answer | None) -> bool:
    """Whether a judge's process ended by a signal that a fault brings about."""
    return answer is not None and answer["answer"] is None and answer.get("code") in _CRASHES


def halted(answer: Answer | None) -> bool:
    """Whether `check` did not end."""
    return answer is not None and answer["answer"] is None and not crashed(answer)


def hung(answer: Answer | None) -> bool:
    """Whether a test went on beyond the time of any sound one."""
    return answer is not None and answer["answer"] is None and answer.get("code") == HUNG
