"""What engines are asked for: one row a function, with its truth."""

from __future__ import annotations

from .constrained import CONSTRAINED as CONSTRAINED
from .function import Function as Function
from .integrators import STEPS as STEPS
from .suiting import FUNCTIONS as FUNCTIONS
from .suiting import suits as suits
from .trees import ALIGNED as ALIGNED
