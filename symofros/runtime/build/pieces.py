"""Long C files in pieces, which compilers take beside each other.

A long function is written as chunks that are never inlined (`generator/codegen/function.py`), so that each may be
compiled in another file: what precedes the chunks is in all files, each chunk in one, declared in the first. Chunks are
compiled one by one either way, so the bits are the same.
"""

from __future__ import annotations

import os
import re

# A chunk, from its head to its closing brace; and a file's fewest, for which another compiler pays.
_CHUNK = re.compile(r"^static (SYM_NOINLINE void \w+_\d+\([^)]*\)) \{\n.*?^\}\n", re.MULTILINE | re.DOTALL)
_FEWEST = 4
_CONDITION = re.compile(r"^#", re.MULTILINE)


def pieces(source: str, processors: int) -> list[str]:
    """The C files that a C file is compiled as: several where it has many chunks, itself alone otherwise.

    Args:
        source: Text of the file.
        processors: Compilers that may run beside each other.
    """
    chunks = list(_CHUNK.finditer(source))
    count = min(processors, len(chunks) // _FEWEST)
    if count < 2 or _CONDITION.search(source, chunks[0].start(), chunks[-1].end()):
        return [source]
    head = source[: chunks[0].start()]
    ends = [len(chunks) * i // count for i in range(count + 1)]
    groups = [chunks[a:b] for a, b in zip(ends, ends[1:], strict=False)]
    kept, at = [], 0
    for chunk in chunks:
        is_here = chunk.start() < groups[0][-1].end()
        kept += [source[at : chunk.start()], chunk[0] if is_here else f"{chunk[1]};\n"]
        at = chunk.end()
    first = "".join([*kept, source[at:]])
    return [first, *(head + "".join(chunk[0].removeprefix("static ") for chunk in group) for group in groups[1:])]


def usable_processors() -> int:
    """Processors that this process may run on."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
