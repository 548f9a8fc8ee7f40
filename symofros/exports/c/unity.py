"""One C file that includes a model and its stepping loop, and shows nothing of them: two such libraries never meet."""

from __future__ import annotations

import re
from collections.abc import Sequence

from symofros.native import amalgamated

_HEADERS = ("math.h", "stddef.h", "stdint.h", "stdio.h", "stdlib.h", "string.h")


MODEL_LOOP = "stepping/symofros_stepper.c"
_VISIBLE = re.compile(r"^SYM_EXPORT [^=;{]*?\b(sym_\w+)\(", re.MULTILINE)


def unity(
    name: str,
    title: str,
    before: Sequence[str],
    after: Sequence[str],
    more_headers: Sequence[str] = (),
    *,
    linked: bool = False,
    included: Sequence[str] = (),
    loop: str = MODEL_LOOP,
) -> str:
    """The text of such a file.

    Args:
        name: Name of the model in C.
        title: Title, for the first line.
        before: Lines between the model and the visible part.
        after: Lines of the visible part.
        more_headers: Headers of the environment, in the form `"mex.h"`.
        linked: Whether the source may be linked with such sources of other models: names of the loop then begin with
            that of the model.
        included: Files that it includes; by default the model, its plant and the loop.
        loop: The C text of the loop.
    """
    own = sorted(set(_VISIBLE.findall(amalgamated(loop)))) if linked else []
    lines = [
        f"/* {title} */",
        *(f"#define {function} {name}_{function}" for function in own),
        "#if !defined(_WIN32) && !defined(_POSIX_C_SOURCE)",
        "#define _POSIX_C_SOURCE 199309L",
        "#endif",
        "#define SYM_EXPORT",
        *(f"#include <{header}>" for header in _HEADERS),
        "#if defined(_WIN32)",
        "#include <windows.h>",
        "#else",
        "#include <time.h>",
        "#endif",
        "#if defined(__linux__)",
        "#include <sys/prctl.h>",
        "#endif",
        *(f"#include {header}" for header in more_headers),
        "#if defined(__GNUC__) && !defined(_WIN32)",
        "#pragma GCC visibility push(hidden)",
        "#endif",
        *(f'#include "{file}"' for file in included or (f"{name}.c", f"{name}_plant.c", "symofros_stepper.c")),
        *before,
        "#if defined(__GNUC__) && !defined(_WIN32)",
        "#pragma GCC visibility pop",
        "#endif",
        *after,
        "",
    ]
    return "\n".join(lines)
