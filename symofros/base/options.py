"""What may be chosen about a compilation; every field enters the cache key."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Literal

from symofros.base.arguments import CheckedCalls, check_fields

# Options that are still accepted: the value that asks for something, and what to do instead.
_WITHOUT_EFFECT = (
    ("tune", True, "one build is made; choose another by compiler= and flags="),
    ("processors", "any", "libraries are for this machine's processor; flags= with another -march is for others"),
)


@dataclass(frozen=True)
class Options(metaclass=CheckedCalls):
    """How to compile a system.

    Attributes:
        functions: What to generate, in one C file; a call of anything else is then an error. None (the default):
            each function when it is first called, by itself or with those that go with it
            (`symofros/base/functions.py`: names, inputs, outputs, units); `Model.prepare` makes some before.
        frames: Frames that frame functions in `functions` are generated for; None: all.
        backend: "c"; "tape", instructions that a program in C interprets: there at once, several times slower than
            compiled code, with the bits of C without contraction; or "interpreter" (NumPy; slow, the reference for the
            C code). Both need no compiler, "tape" where a wheel brings its machine.
        background: Whether a model answers on tape at once while C is compiled in another process; `Model.ready` gives
            the compiled model, and the next `compile` has what is in the cache by then.
        flags: Flags of the C compiler, in place of the default.
        compiler: Path or name of the C compiler; None: $CC, cc, gcc, clang, then the ziglang package.
        constraints: How forward dynamics keeps them: "multipliers" solves for the forces first, by M^-1;
            "null_space" for the accelerations that are left free, without M^-1: more accurate where M is nearly
            singular, and usually slower (docs/theory/constraints.md, section 8). Derivatives and projection go by
            multipliers, whatever is chosen here.
        forward_dynamics: How trees are solved: by "factors" of the mass matrix; by "articulated" bodies, which lose
            hundreds of times fewer digits where light links carry heavy loads; "auto", the cheaper by count
            (docs/theory/rigid.md, section 7). "articulated" also holds for the first derivatives, vector-Jacobian
            products and `linearize`, whose code is then up to twice as long ("auto": factors); models with rotors
            that it can't serve are refused. Constraints, Hessians of forward dynamics and implicit steps need M
            itself: they are solved by factors, whatever is chosen here. `Model.routes` tells what was chosen and why.
        batch: How large batches are evaluated: "vector", several states at once, by code that is compiled for each
            function when its first batch of 256 states or more arrives (docs/theory/code.md); or "loop", one by one.
        packs: Whether values of one state formed by the same operations share vectors: entries of a row of M, say, or
            what is computed for each of several equal legs.
        tune: Without effect, which True is warned of: one build is made, which `compiler` and `flags` choose.
        processors: Without effect, which "any" is warned of: libraries are compiled for this machine's processor. A
            cache folder may be shared, since each kind of processor has libraries of its own there; for a library that
            other processors load, state `flags`, such as ("-O2", "-march=x86-64-v2").
    """

    functions: tuple[str, ...] | None = None
    frames: tuple[str, ...] | None = None
    backend: Literal["c", "tape", "interpreter"] = "c"
    flags: tuple[str, ...] | None = None
    compiler: str | None = None
    constraints: Literal["multipliers", "null_space"] = "multipliers"
    forward_dynamics: Literal["auto", "articulated", "factors"] = "auto"
    batch: Literal["vector", "loop"] = "vector"
    packs: bool = True
    background: bool = False
    tune: bool = False
    processors: Literal["native", "any"] = "native"

    def __post_init__(self) -> None:
        """Convert lists to tuples, for the cache key; refuse fields of the wrong type, warn of those without effect."""
        for name in ("functions", "frames", "flags"):
            if isinstance(getattr(self, name), list):
                object.__setattr__(self, name, tuple(getattr(self, name)))
        check_fields(self)
        for name, asked, instead in _WITHOUT_EFFECT:
            if getattr(self, name) == asked:
                # Whoever calls Options stands behind its __init__ and its metaclass.
                warnings.warn(f"Options({name}={asked!r}) has no effect: {instead}", FutureWarning, stacklevel=4)
