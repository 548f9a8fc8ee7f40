"""A cross-check in five lines: does our C agree with Pinocchio, MuJoCo and Exudyn? Needs the extra `validation`."""

from reference_models import MODELS
from validation.check import Settings, check
from validation.contract.interface import Subject

result = check(Subject("double_pendulum", MODELS["double_pendulum"]), Settings(states=20))
for row in result.compared:
    print(f"{row.quantity:28s} {row.engine:12s} error {row.error:.1e} of at most {row.tolerance:.0e}: {row.status}")
print(f"{len(result.compared)} comparisons,", "all agree" if result.ok else "not all agree")
