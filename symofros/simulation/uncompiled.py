"""What is called with a description where a compiled model belongs."""

from __future__ import annotations

from symofros.errors import Problem, SymofrosError
from symofros.runtime.model import Model


def refuse_uncompiled(model: object) -> None:
    """Refuse what is no model.

    Raises:
        SymofrosError: It is a System, the path of a file, or something else.
    """
    if isinstance(model, Model):
        return
    remedy = "sf.compile(sf.load(path))" if isinstance(model, str) else "sf.compile(system) makes one of a System"
    raise SymofrosError(
        Problem(
            "there is no compiled model", f"{type(model).__name__} {model!r:.60}", "it takes a compiled Model", remedy
        )
    )
