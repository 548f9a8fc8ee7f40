"""The reports, in the order of the index and of `python -m validation all`."""

from __future__ import annotations

from ..accuracy import catalogue as accuracy
from ..adversary import report as adversary
from ..campaigns import report as campaign
from ..cross_check import report as check
from ..cuda import report as cuda
from ..diagrams import catalogue as diagrams
from ..engines import report as engines
from ..environments import report as environments
from ..mutation import report as mutants
from ..pareto import report as pareto
from ..recall import report as recall
from ..reporting.record import Topic
from ..stability import report as stability
from ..studies import exports, fuzz, mutation, oracle, rollouts, studio
from ..timing import report as timing

_TRUTH = (check, oracle, mutation, mutants, fuzz, adversary, engines, recall, campaign)
_CORRECTNESS = (*_TRUTH, accuracy, diagrams, stability)
_SPEED = (timing, rollouts, exports, environments, cuda, pareto)
TOPICS: dict[str, Topic] = {module.TOPIC.name: module.TOPIC for module in (*_CORRECTNESS, *_SPEED, studio)}
