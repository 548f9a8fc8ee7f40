"""Names that mean something else where nobody quotes them, and random systems that bear them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

import symofros as sf
from reference_models.rigid.random_tree import MORE_KINDS, random_tree
from symofros.base.names import symbol_of
from symofros.expr.expression import spelled
from symofros.mechanics.topology.coordinates import coordinate_names, coordinate_symbols, speed_symbols

HOSTILE = (
    *("a", "b", "a-b", "a - b", "a*b", "a/b", "L/R", "c d", "a::b", "left-hip", "1", "1e3", "2a", "-a", "0x1f"),
    *("t", "pi", "sin", "max", "x", "xi", "e", "null", "~", "true", "on", ".nan", "<<", "=", "#", "- a", "? a"),
    *(": ", "a: b", "[a]", "{a}", "a,b", "'", '"', "''", "`", "a`b", "``", "\\", "%", "@", "&a", "*a", "!a", "|", ">"),
    *("ü", "関節", "α_1", "__a__", "class", "lambda", "int", "é́", " a", "a ", "  "),
    *("a.b", "a..b", ".a", "a[0]", "a[b]"),
    *("d", "dd", "door", "oor", "(a)", "a^b", "a**b", "$HOME", "${a}", "?", "*/", "//", "??/"),
)


def hostile_system(seed: int) -> sf.System:
    """A tree of three bodies whose every name is hostile, with formulas of them; equal seeds give equal systems."""
    rng = np.random.default_rng(seed)
    names = [str(name) for name in rng.permutation(HOSTILE)]
    tree = random_tree(seed, 3, MORE_KINDS)
    called = {body.name: names.pop() for body in tree.bodies}
    bodies: list[sf.Body] = []
    for body in tree.bodies:
        assert isinstance(body, sf.RigidBody)
        frames = {frame.name: names[-1 - k] for k, frame in enumerate(body.frames)}
        joint = body.joint
        if joint is not None:
            parent = tree.body(joint.parent)
            mounts = {frame.name: bodies[tree.bodies.index(parent)].frames[k] for k, frame in enumerate(parent.frames)}
            frame = None if joint.frame is None else mounts[joint.frame].name
            joint = replace(joint, name=names.pop(), parent=called[parent.name], frame=frame)
        shown = tuple(replace(frame, name=frames[frame.name]) for frame in body.frames)
        bodies.append(replace(body, name=called[body.name], joint=joint, frames=shown))
    return _with_formulas(replace(tree, name=names.pop(), bodies=tuple(bodies)), names, rng)


def _with_formulas(system: sf.System, names: list[str], rng: np.random.Generator) -> sf.System:
    """The system with efforts, a coupling, a condition on speeds, a potential, virtual power, an input, a parameter."""
    joints = [body.joint for body in system.bodies if body.joint is not None and body.joint.kind != "fixed"]
    q = [name for joint in joints for name in coordinate_symbols(joint)]
    v = [name for joint in joints for name in speed_symbols(joint)]
    taken = {name for joint in joints for name in (*coordinate_names(joint), *speed_symbols(joint))}
    free = [name for name in names if name not in taken and name not in ("t", "pi")]
    parameter, inlet = free[:2]
    # A coordinate that is the rate of another by name is refused in formulas of speeds: see unclear.txt.
    safe = [name for name in (*q, *v) if not ({*q} & {*v} & {name})] or ["t"]

    def formula(symbols: Sequence[str]) -> str:
        a, b = (spelled(str(symbols[int(rng.integers(len(symbols)))])) for _ in range(2))
        terms = [f"{rng.uniform(-2, 2):.3g}*{a}", f"sin({b})", f"{a}*{b}", f"-{a}^2/({spelled(parameter)} + 3)", "pi"]
        return " - ".join(str(term) for term in rng.permutation(terms)[:3])

    motion = [*safe, symbol_of(inlet), parameter]
    bodies = [
        body
        if body.joint is None or body.joint.kind == "fixed"
        else replace(body, joint=replace(body.joint, effort=tuple(formula(motion) for _ in speed_symbols(body.joint))))
        for body in system.bodies
    ]
    return replace(
        system,
        bodies=tuple(bodies),
        inputs=(sf.Input(inlet),),
        parameters=(sf.Parameter(parameter, 1.5),),
        constraints=(
            sf.Coupling(names[0], f"{spelled(q[0])}*{spelled(parameter)} + {formula(q)}"),
            sf.Nonholonomic(names[1], {str(rng.choice(v)): f"1 + {spelled(q[0])}^2"}),
        ),
        potentials=(sf.Potential(names[2], formula(q)),),
        virtual_power=(sf.VirtualPower(names[3], {str(rng.choice(v)): formula(motion)}),),
    )
