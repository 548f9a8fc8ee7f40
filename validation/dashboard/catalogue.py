"""The reports, in the order of the index and of `--regenerate`."""

from __future__ import annotations

from validation.accuracy import catalogue as accuracy
from validation.adversary import report as adversary
from validation.campaigns import report as campaign
from validation.cross_check import report as check
from validation.cuda import report as cuda
from validation.diagrams import catalogue as diagrams
from validation.engines import report as engines
from validation.environments import report as environments
from validation.mutation import report as mutants
from validation.pareto import report as pareto
from validation.passes import report as passes
from validation.reporting.record import Topic
from validation.stability import report as stability
from validation.studies.reports import exports, fuzz, mutation, oracle, realtime, rollouts, simulation
from validation.timing import report as timing

_CORRECTNESS = (check, oracle, mutation, mutants, fuzz, adversary, engines, campaign, accuracy, diagrams, stability)
_SPEED = (timing, simulation, rollouts, realtime, passes, exports, environments, cuda, pareto)
TOPICS: dict[str, Topic] = {module.TOPIC.name: module.TOPIC for module in (*_CORRECTNESS, *_SPEED)}
