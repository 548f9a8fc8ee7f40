"""The packages of a wheel: the harness and the reference models are installed within the one package `symofros`."""

from pathlib import Path

from setuptools import setup

# Folder of the repository -> the name that it is installed under; everything else is in pyproject.toml.
INSTALLED = {
    "symofros": "symofros",
    "validation": "symofros.validation",
    "reference_models": "symofros.reference_models",
}
FOLDERS = sorted({path.parent for name in INSTALLED for path in Path(name).rglob("*.py")})

setup(
    package_dir={name: folder for folder, name in INSTALLED.items()},
    packages=[".".join((INSTALLED[top], *below)) for top, *below in (folder.parts for folder in FOLDERS)],
)
