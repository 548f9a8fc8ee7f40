"""DART's constraints between bodies: welds and balls, which hold at the end of a step of its world."""

from __future__ import annotations

from ...interface import STEP, Tree
from ..writing.source import ways_of

KINDS = {"weld": "WeldJointConstraint", "point": "BallJointConstraint"}
# Constraints are made where the skeleton stands, and hold what they find there.
_WORLD = f"""w = dart.simulation.World()
w.setTimeStep({STEP}); w.setGravity(s.getGravity() * GRAVITY); w.addSkeleton(s)
for kind, first, place, other in held_by:
    ends = [links[k] for k in (first, other) if k >= 0]
    if kind == 'point':
        X = links[first].getTransform()
        ends.append(X.rotation() @ place + X.translation())
    w.getConstraintSolver().addConstraint(getattr(dart.constraint, KINDS[kind])(*ends))
""".replace("KINDS", repr(KINDS))
# Part of a speed that its ConstraintForceMixing leaves, of constraints that others nearly imply.
_MIXED = 1e-6
WAYS = ways_of(f"""
== step_bound ~ {_MIXED} | World.step with a constraint: speeds
s.setPositions(q); s.setVelocities(v2)
{_WORLD.replace("GRAVITY", "1.0")}s.setForces(tau)
w.step()
value = s.getVelocities()
== step_at_rest ~ {_MIXED} | World.step with a constraint
kept = s.getGravity()
s.setPositions(q); s.setVelocities(0 * q)
{_WORLD.replace("GRAVITY", "0.0")}w.step()
value = np.r_[s.getPositions(), s.getVelocities()]
s.setGravity(kept)
""")


def bound(tree: Tree) -> dict[str, tuple[str, ...]]:
    """Statements that list the constraints: kind, link, place in it, other link; the world is the link -1."""
    if not tree.constraints:
        return {}
    names = [link.name for link in tree.links]
    rows = []
    for one in tree.constraints:
        first, other = sorted(one.ends, key=lambda end: not end.link)
        numbers = [names.index(end.link) if end.link else -1 for end in (first, other)]
        rows.append(f"({one.kind!r}, {numbers[0]}, np.array({list(first.p)!r}), {numbers[1]})")
    return {"held_by": (f"held_by = [{', '.join(rows)}]",)}
