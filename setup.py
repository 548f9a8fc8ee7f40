"""The packages of a wheel: the harness and the reference models are installed within the one package `symofros`."""

import platform
from pathlib import Path

from setuptools import Distribution, setup
from setuptools.command.bdist_wheel import bdist_wheel
from setuptools.command.build_py import build_py

# Folder of the repository -> the name that it is installed under; everything else is in pyproject.toml.
INSTALLED = {
    "symofros": "symofros",
    "validation": "symofros.validation",
    "reference_models": "symofros.reference_models",
}
FOLDERS = sorted({path.parent for name in INSTALLED for path in Path(name).rglob("*.py")})
# Pages that the editor's windows show; the programs that make a site of them stay behind.
DOCS = "symofros.docs"
# Made by .ci/prebuild.py, for machines without a C compiler.
LIBRARIES = sorted(Path("symofros/native/prebuilt").glob("*.so"))


class Libraries(Distribution):
    """What lies beside modules in the folder of one platform."""

    def has_ext_modules(self) -> bool:
        """Whether there is something of one platform."""
        return bool(LIBRARIES)


class Wheel(bdist_wheel):
    """A wheel of one kind of machine where libraries are in it, else one of all; of any Python in either case."""

    def get_tag(self) -> tuple[str, str, str]:
        """Tags of Python, its binary interface, and the platform."""
        return "py3", "none", f"manylinux_2_17_{platform.machine()}" if LIBRARIES else "any"


class Modules(build_py):
    """Modules of all packages but the documentation."""

    def find_package_modules(self, package: str, package_dir: str) -> list[tuple[str, str, str]]:
        """Package, name and file of each module."""
        return [] if package == DOCS else super().find_package_modules(package, package_dir)


setup(
    package_dir={name: folder for folder, name in INSTALLED.items()} | {DOCS: "docs"},
    packages=[".".join((INSTALLED[top], *below)) for top, *below in (folder.parts for folder in FOLDERS)] + [DOCS],
    distclass=Libraries,
    cmdclass={"bdist_wheel": Wheel, "build_py": Modules},
)
