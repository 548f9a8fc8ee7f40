"""The search of one attack: Hypothesis draws scenes until the budget is spent, and shrinks what it finds."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Set
from dataclasses import dataclass, field
from pathlib import Path

from hypothesis import HealthCheck, Phase, Verbosity, given, seed, settings
from hypothesis.database import DirectoryBasedExampleDatabase
from hypothesis.errors import Flaky

from .attack import Attack, Scene, Verdict

# Scenes a round: after each, the search begins anew with the next seed, and what was found is written.
ROUND = 200


@dataclass
class Tally:
    """How many scenes ended how.

    Attributes:
        tried: Scenes judged.
        agreed: Scenes where the independent route agrees.
        refused: Scenes that we refused ourselves.
        undecided: Scenes of which the independent route has no answer.
        again: Scenes that contradict a claim that a find contradicts already.
        rounds: Rounds begun; the seed of the next one.
        seconds: CPU time spent [s].
        largest: Largest error over its bound among those that agreed.
    """

    tried: int = 0
    agreed: int = 0
    refused: int = 0
    undecided: int = 0
    again: int = 0
    rounds: int = 0
    seconds: float = 0.0
    largest: float = 0.0


@dataclass(frozen=True)
class Find:
    """A scene that is answered as good and is not.

    Attributes:
        attack: Name of the attack.
        scene: Scene, as small as it could be made.
        said: Sentence on the contradiction.
        quantity: What is contradicted, with the choices in words that the scene makes, such as a method.
    """

    attack: str
    scene: Scene
    said: str
    quantity: str


@dataclass
class Budget:
    """What a search may spend.

    Attributes:
        seconds: CPU time [s].
        examples: Number of scenes.
    """

    seconds: float
    examples: int
    begun: float = field(default_factory=time.process_time)
    tried: int = 0

    @property
    def spent(self) -> float:
        """CPU time spent [s]."""
        return time.process_time() - self.begun

    @property
    def over(self) -> bool:
        """Whether no budget is left."""
        return self.spent >= self.seconds or self.tried >= self.examples


class _Spent(BaseException):
    """End of the time: no Exception, so that it is not taken for a find and shrunk."""


class _Contradiction(Exception):
    """What Hypothesis shrinks."""


def hunt(
    attack: Attack,
    folder: Path,
    first_seed: int,
    budget: Budget,
    tally: Tally,
    known: Set[str],
    progress: Callable[[], None] = lambda: None,
) -> Find | None:
    """One round: at most ROUND scenes, until the first find or the end of the budget.

    Args:
        attack: Attack.
        folder: Folder of the database of examples.
        first_seed: Seed of the first round; each round has the next.
        budget: What may be spent.
        tally: Counts, which go up.
        known: Quantities that were contradicted before: a scene that contradicts them is counted, and passed over.
        progress: Called after each scene.
    """
    smallest: list[tuple[Scene, Verdict]] = []
    begun = budget.spent

    def one(scene: Scene) -> None:
        if budget.over:
            raise _Spent
        verdict = attack.verdict(scene)
        budget.tried += 1
        tally.tried += 1
        progress()
        if verdict.sound:
            setattr(tally, verdict.kind, getattr(tally, verdict.kind) + 1)
            tally.largest = max(tally.largest, verdict.share)
        elif (what := quantity_of(scene, verdict)) in known or (smallest and what != quantity_of(*smallest[0])):
            tally.again += 1
        else:
            if not smallest or _size(scene) <= _size(smallest[-1][0]):
                smallest.append((scene, verdict))
            raise _Contradiction

    search = _settings(folder / "examples" / attack.name, min(ROUND, max(1, budget.examples - budget.tried)))
    try:
        search(seed(first_seed + tally.rounds)(given(attack.scenes)(one)))()
    except (_Contradiction, _Spent, Flaky):
        pass
    except BaseException:  # Ctrl-C: what was found stays in the database, and is found first when the search goes on.
        tally.seconds += budget.spent - begun
        raise
    tally.rounds += 1
    tally.seconds += budget.spent - begun
    if not smallest:
        return None
    scene, verdict = smallest[-1]
    return Find(attack.name, scene, verdict.said, quantity_of(scene, verdict))


def _settings(folder: Path, count: int) -> settings:
    """Settings of a search for at most so many scenes, whose examples are kept in a folder."""
    return settings(
        database=DirectoryBasedExampleDatabase(folder),
        max_examples=count,
        deadline=None,
        suppress_health_check=list(HealthCheck),
        verbosity=Verbosity.quiet,
        phases=(Phase.reuse, Phase.generate, Phase.shrink),
        report_multiple_bugs=False,
        print_blob=False,
    )


def quantity_of(scene: Scene, verdict: Verdict) -> str:
    """Key of a find among those of its attack: the contradicted quantity and the scene's string values."""
    words = sorted(value for value in scene.values() if isinstance(value, str))
    return ", ".join((verdict.quantity, *words))


def _size(scene: Scene) -> tuple[int, str]:
    text = json.dumps(scene, sort_keys=True)
    return len(text), text
