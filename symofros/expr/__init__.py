"""The language of values: a hash-consed graph of scalar operations. Knows no mechanics."""

from __future__ import annotations

from symofros.expr.derivative import partials as partials
from symofros.expr.edges import ONE as ONE
from symofros.expr.edges import ZERO as ZERO
from symofros.expr.edges import Edge as Edge
from symofros.expr.expression import CONSTANTS as CONSTANTS
from symofros.expr.expression import Expression as Expression
from symofros.expr.expression import NoValueError as NoValueError
from symofros.expr.expression import evaluate as evaluate
from symofros.expr.expression import lower as lower
from symofros.expr.expression import spelled as spelled
from symofros.expr.factors import Factors as Factors
from symofros.expr.garbage import collect_rarely as collect_rarely
from symofros.expr.graph import Graph as Graph
from symofros.expr.graph import Slot as Slot
from symofros.expr.instants import OPERANDS as OPERANDS
from symofros.expr.instants import InstantKind as InstantKind
from symofros.expr.instants import instant_operands as instant_operands
from symofros.expr.instants import with_instants as with_instants
from symofros.expr.numerics.evaluate import needed_nodes as needed_nodes
from symofros.expr.ops import ADD as ADD
from symofros.expr.ops import DIV as DIV
from symofros.expr.ops import MUL as MUL
from symofros.expr.ops import OPS as OPS
from symofros.expr.ops import STOP_GRADIENT as STOP_GRADIENT
from symofros.expr.program import Function as Function
from symofros.expr.program import Output as Output
from symofros.expr.program import Program as Program
from symofros.expr.program import Solver as Solver
from symofros.expr.substitute import copy_into as copy_into
from symofros.expr.terms import Terms as Terms
from symofros.expr.terms import edges_of as edges_of
from symofros.expr.terms import terms as terms
