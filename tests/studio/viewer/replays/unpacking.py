"""Recordings as the pages of replays restore them, by their own script, run by Node.js."""

from __future__ import annotations

import base64
import re
import shutil
import subprocess
from importlib import import_module
from importlib.resources import files
from typing import Any

import pytest

_SCRIPT = files("symofros.studio.viewer.replays") / "unpack.js"


def decoded(recording: bytes) -> tuple[dict[str, Any], list[bytes]]:
    """What a recording of viser holds, and its arrays."""
    whole = import_module("zstandard").ZstdDecompressor().decompress(recording[8:], max_output_size=1 << 26)
    assert len(whole) == int.from_bytes(recording[:8], "little")
    start = 8 + int.from_bytes(whole[:8], "little")
    found, arrays = import_module("msgspec").msgpack.decode(whole[8:start]), []
    for size in found["binaryBufferLengths"]:
        start = -(-start // 8) * 8
        arrays.append(whole[start : start + size])
        start += size
    assert start == len(whole)
    return found, arrays


def unpacked(packed: str) -> bytes:
    """The recording that a packed one stands for, in base64."""
    node = shutil.which("node")
    if node is None:
        pytest.skip("needs Node.js")
    program = _SCRIPT.read_text(encoding="utf-8").partition('unpack("/*packed*/")')[0]
    done = subprocess.run(
        [node, "-e", program + 'unpack(require("fs").readFileSync(0, "utf8")).then(console.log)'],
        input=packed,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.returncode == 0, done.stderr
    return base64.b64decode(done.stdout)


def messages_of(page: str) -> list[tuple[float, dict[str, Any]]]:
    """Times and messages of a replay's page, times rounded to a microsecond."""
    (packed,) = re.findall(r'unpack\("([A-Za-z0-9+/=]+)"\)', page)
    return [(round(time, 6), message) for time, message in decoded(unpacked(packed))[0]["messages"]]
