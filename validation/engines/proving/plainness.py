"""Scripts without what says nothing: defaults of files' formats, and zeros behind points.

What is left means the same by the formats; whether it does to the engine is seen when it runs: `scripts.prove` keeps
what a script says with it only where its value is what the cell's was.
"""

from __future__ import annotations

import re

# Pattern -> replacement, in the text of a script.
_NUMBERS = (
    # Whole numbers in quotes or between tags; those of Python's lists stay floating-point numbers.
    (r"(?<=[\" >])(-?\d+)\.0(?=[\" <])", r"\1"),
    (r"(?<=[\" >])-0(?=[\" <])", "0"),
    # Breaks between tags that a string states by escapes.
    (r">\\n<", "><"),
)
_DEFAULTS = (
    # URDF.
    (r' rpy="0 0 0"', ""),
    (r' xyz="0 0 0"(?=( rpy="[^"]*")?/>)', ""),
    (r"<origin ?/>", ""),
    (r'<axis xyz="1 0 0"/>', ""),
    (r'<limit lower="-100" upper="100" effort="1e9" velocity="1e9"/>', '<limit effort="9" velocity="9"/>'),
    # MJCF.
    (r'(<body [^>]*?) pos="0 0 0"', r"\1"),
    (r'(<(?:body|site) [^>]*?) xyaxes="1 0 0 0 1 0"', r"\1"),
    (r'(<site [^>]*?) pos="0 0 0"', r"\1"),
    (r' fullinertia="(\S+) (\S+) (\S+) 0 0 0"', r' diaginertia="\1 \2 \3"'),
    (r'<option gravity="0 0 -9.81"/>', ""),
    (r' model="tree"', ""),
    # SDF.
    (r"<pose>0 0 0 0 0 0</pose>", ""),
    (r"<(i(?:xy|xz|yz))>0</\1>", ""),
)


def plain(script: str, *, defaults: bool = True) -> str:
    """The script without them.

    Args:
        script: The script.
        defaults: Whether formats' defaults go; there are readers that know none of them.
    """
    for pattern, replacement in _NUMBERS + _DEFAULTS * defaults:
        script = re.sub(pattern, replacement, script)
    return script
