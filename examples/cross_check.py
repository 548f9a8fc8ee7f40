"""A cross-check in three lines: does our C agree with Pinocchio, MuJoCo and Exudyn? Needs the extra `validation`."""

from symofros.reference_models import MODELS
from symofros.validation import check

result = check(MODELS["double_pendulum"], states=20)
for row in result.compared:
    print(f"{row.quantity:28s} {row.engine:12s} error {row.error:.1e} of at most {row.tolerance:.0e}: {row.status}")
print(result)
