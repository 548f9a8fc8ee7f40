"""The libraries of hand-written C that a wheel brings for machines without a compiler: symofros/native/prebuilt/.

    python .ci/prebuild.py [FOLDER]     # FOLDER: symofros/native/prebuilt by default

They are compiled by `zig cc` (the package ziglang) against an old glibc, for any x86-64 processor since 2009 and any
aarch64 one, whichever this machine is. Their names say which C text they are of: others are not loaded.
"""

from __future__ import annotations

import platform
import subprocess
import sys
import tempfile
from pathlib import Path

from symofros.generator.codegen.tape import machine_text
from symofros.native import HEADERS, native_text
from symofros.runtime.build.prebuilt import prebuilt_name
from symofros.runtime.calls.binding import native_source

GLIBC = "2.17"  # As manylinux2014 has it.
CPU = {"x86_64": "x86_64_v2", "aarch64": "generic"}
FLAGS = ("-O3", "-std=gnu99", "-fno-math-errno", "-shared", "-fPIC", "-fvisibility=hidden", "-pthread", "-s")


def main(folder: Path) -> None:
    """Compile both libraries into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("*.so"):
        old.unlink()
    machine = platform.machine()
    target = (f"--target={machine}-linux-gnu.{GLIBC}", f"-mcpu={CPU[machine]}")
    # The tape machine rounds each operation by itself.
    for source, more in ((native_source(), ()), (machine_text(), ("-ffp-contract=off",))):
        with tempfile.TemporaryDirectory() as private:
            place = Path(private)
            (place / Path(HEADERS[0]).name).write_text(native_text(HEADERS[0]), encoding="utf-8")
            (place / "library.c").write_text(source, encoding="utf-8")
            library = folder.resolve() / prebuilt_name(source)
            command = [sys.executable, "-m", "ziglang", "cc", *target, *FLAGS, *more, "library.c", "-lm"]
            subprocess.run([*command, "-o", str(library)], cwd=place, check=True)
        print(f"{library.name}: {library.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    package = Path(__file__).parents[1] / "symofros"
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else package / "native" / "prebuilt")
