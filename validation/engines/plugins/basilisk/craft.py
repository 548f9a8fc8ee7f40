"""Spacecraft by Basilisk: a free hub with hinged and sliding bodies, panels, wheels, particles of fuel."""

from __future__ import annotations

import numpy as np

from ...interface import STEP, Array, Joint, Link, Slot, Tree, Unsupported
from ..writing.source import Source, Way, series
from . import craft_text

_MODULES = (
    "extForceTorque spacecraft spinningBodyNDOFStateEffector spinningBodyOneDOFStateEffector"
    " spinningBodyTwoDOFStateEffector linearTranslationNDOFStateEffector linearTranslationOneDOFStateEffector"
    " hingedRigidBodyStateEffector dualHingedRigidBodyStateEffector nHingedRigidBodyStateEffector"
    " linearSpringMassDamper reactionWheelStateEffector"
)
# Second ways -> kind of their joints, the class of the text that has them, length of the chains that it is for.
_OTHERS = {
    "one hinge": ("hinge", "OneHinge", 1),
    "two hinges": ("hinge", "TwoHinges", 2),
    "one slide": ("slide", "OneSlide", 1),
    "panel": ("hinge", "Panel", 1),
    "two panels": ("hinge", "TwoPanels", 2),
    "panels": ("hinge", "Panels", 0),
    "particle": ("slide", "Particle", 1),
    "wheel": ("hinge", "Wheel", 1),
}
_NAMES = {"hinge": "Hinges", "slide": "Slides"}
_CODES = {
    "craft_accelerations": ("equationsOfMotion", "value = Craft(classes).rates(q, v, tau)", 0.0),
    "craft_accelerations_coasting": ("equationsOfMotion", "value = Craft(classes).rates(q, v)", 0.0),
    "craft_energy": (
        "totOrbEnergy, totRotEnergy",
        "c = Craft(classes)\nc.rates(q, v, tau)\nt = c.totals()\nvalue = [t.totOrbEnergy + t.totRotEnergy]",
        0.0,
    ),
    "craft_angular_momentum": (
        "totRotAngMomPntC_N",
        "c = Craft(classes)\nc.rates(q, v, tau)\nvalue = np.ravel(c.totals().totRotAngMomPntC_N)",
        0.0,
    ),
    "craft_logs_against_states": (
        "spinningBodyConfigLogOutMsgs, translatingBodyConfigLogOutMsgs",
        f"value = Craft(classes).logs_against_states(q, v2, tau, {STEP})",
        0.0,
    ),
    # Attitudes are integrated as other parameters than ours.
    "craft_poses_after_step": ("ConfigLogOutMsg", f"value = Craft(classes).moved(q, v2, tau, {STEP})", 1e-6),
}
# What effectors have no motors, and no logs of where they are.
_UNDRIVEN, _UNLOGGED = ("panels", "particle"), ("particle", "wheel")


def _ways() -> dict[str, Way]:
    ways = {}
    for name, (native, code, slack) in _CODES.items():
        ways[name] = Way(f"SpinningBodyNDOF, LinearTranslationNDOF: {native}", code, slack)
        for other, (kind, effector, _) in _OTHERS.items():
            if (other in _UNDRIVEN and name != "craft_accelerations_coasting") or (
                other in _UNLOGGED and name in ("craft_poses_after_step", "craft_logs_against_states")
            ):
                continue
            built = ((f"'{kind}': {_NAMES[kind]}", f"'{kind}': {effector}"),)
            ways[f"{name}:{other}"] = Way(f"{effector}: {native}", code, slack, built)
    return ways


WAYS = _ways()


def _plain(values: object) -> str:
    return f"np.array({np.asarray(values, dtype=float).tolist()!r})"


def _is_panel(link: Link, after: Link | None) -> bool:
    """Whether a hinge is along y, with the mass centre and the next hinge at -x, and no products of inertia."""
    joint, J = link.joints[0], np.array(link.inertia)
    is_next = after is None or (np.array_equal(after.joints[0].R, np.eye(3)) and not np.any(after.joints[0].p[1:]))
    return (
        bool(joint.axis == (0.0, 1.0, 0.0) and not np.any(link.com[1:]) and not np.any(J - np.diag(np.diag(J))))
        and is_next
    )


def _is_degenerate(chains: list[tuple[str, list[Link]]]) -> bool:
    """Whether some body has no mass, or no inertia."""
    return any(not one.mass or not np.any(one.inertia) for _, links in chains for one in links)


def _suits(other: str, chains: list[tuple[str, list[Link]]]) -> bool:
    """Whether all chains of a kind are what the effector of a second way has."""
    kind, _, length = _OTHERS[other]
    own = [links for one, links in chains if one == kind]
    if not own or any(length and len(links) != length for links in own):
        return False
    if other not in _UNLOGGED and _is_degenerate(chains):
        return False
    pairs = [(one, after) for links in own for one, after in zip(links, [*links[1:], None], strict=True)]
    lone = [one for one, _ in pairs]
    match other:
        case "one slide":
            return len(own) == 1
        case "panel":
            return all(_is_panel(*pair) for pair in pairs)
        case "two panels":
            return all(_is_panel(*pair) for pair in pairs) and not any(one.joints[0].rest for one in lone)
        case "panels":
            same = {(one.mass, one.com, one.inertia) for one in lone}
            apart = all(after is None or after.joints[0].p[0] == 2 * one.com[0] for one, after in pairs)
            return all(_is_panel(*pair) for pair in pairs) and len(same) == 1 and apart
        case "particle":
            return all(not np.any(one.inertia) and not np.any(one.com) and not one.joints[0].rest for one in lone)
        case "wheel":
            return all(one.joints[0].axis == (1.0, 0.0, 0.0) and not one.joints[0].stiffness for one in lone) and all(
                not one.mass or one.name.startswith("wheel") for one in lone
            )
    return True


def _body(R: Array, p: Array, joint: Joint, link: Link) -> str:
    parts = (R, p, joint.axis)
    forces = f"{joint.stiffness!r}, {joint.damping!r}, {joint.rest!r}"
    return f"({', '.join(map(_plain, parts))}, {link.mass!r}, {_plain(link.com)}, {_plain(link.inertia)}, {forces})"


def write(tree: Tree) -> Source | Unsupported:
    """Text of a hub and its chains of hinges or of slides."""
    hub, *others = tree.links
    chains: list[tuple[str, list[Link]]] = []
    places: dict[int, int] = {}
    for k, link in enumerate(others, 1):
        kind = {"revolute": "hinge", "prismatic": "slide"}[link.joints[0].kind]
        if link.parent == 0:
            chains.append((kind, []))
        places[k] = len(chains) - 1 if link.parent == 0 else places[link.parent]
        chains[places[k]][1].append(link)
    texts = []
    for kind, links in chains:
        bodies = []
        for link in links:
            ((R, p, joint),), _ = series(link.joints)
            bodies.append(_body(R, p, joint, link))
        texts.append(f"({kind!r}, [{', '.join(bodies)}])")
    lines = (
        "from itertools import groupby",
        "import numpy as np",
        "from Basilisk.architecture import bskLogging, messaging",
        f"from Basilisk.simulation import {', '.join(_MODULES.split())}",
        "bskLogging.setDefaultLogLevel(bskLogging.BSK_ERROR)",
        *craft_text.CRAFT.split("\n"),
        f"hub = ({hub.mass!r}, {_plain(hub.com)}, {_plain(hub.inertia)})",
        f"chains = [{', '.join(texts)}]",
        "classes = {'hinge': Hinges, 'slide': Slides}",
    )
    free = Slot("free wxyz, linear before and angular after", tuple(range(7)), tuple(range(6)))
    slots = [(free,)]
    slots += [
        (Slot("angle" if link.joints[0].kind == "revolute" else "length", (6 + k,), (5 + k,)),)
        for k, link in enumerate(others, 1)
    ]
    lacks = [
        way
        for way in WAYS
        if (not _suits(other, chains) if (other := way.partition(":")[2]) else _is_degenerate(chains))
    ]
    return Source(lines, tuple(slots), 6 + len(tree.links), 5 + len(tree.links), lacks=tuple(lacks))
