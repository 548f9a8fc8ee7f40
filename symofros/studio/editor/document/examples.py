"""Models and diagrams to begin with: which reference models the page offers, in which words, and their files."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from symofros.harness import folder_of
from symofros.studio.editor.document.workspace import FileError, Workspace, read_text, write
from symofros.studio.editor.editing.data_edits import EditError

Json = dict[str, Any]


@dataclass(frozen=True)
class Example:
    """One entry of File > Examples.

    Attributes:
        file: Its file in the folder of the reference models.
        title: Its name in words.
        about: What it shows, in a sentence.
        models: Files that a diagram reads, which go beside it.
        posture: Coordinates at which its picture is taken.
    """

    file: str
    title: str
    about: str
    models: tuple[str, ...] = ()
    posture: Mapping[str, float] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Name of its document, and of its picture."""
        return Path(self.file).stem

    @property
    def kind(self) -> str:
        """The kind of its document: "diagram" or "mechanism"."""
        return "diagram" if self.models else "mechanism"


EXAMPLES = (
    Example(
        "rigid/double_pendulum.yaml",
        "Double pendulum",
        "Two rods on two joints. The tour begins here.",
        posture={"q1": 0.9, "q2": -1.2},
    ),
    Example("rigid/cart_pole.yaml", "Cart and pole", "A slide, a hinge, and a force as an input.", posture={"q": 0.35}),
    Example(
        "rigid/puma560.yaml",
        "Industrial arm",
        "A PUMA 560: six joints with the inertia of their motors.",
        posture={"q1": 0.4, "q2": -0.6, "q3": 0.4, "q5": 0.5},
    ),
    Example(
        "rigid/stanford_arm.yaml",
        "Stanford arm",
        "Five hinges and a slide.",
        posture={"q1": 0.5, "q2": 1.0, "d3": 0.4},
    ),
    Example("rigid/car.yaml", "Car", "A free body on four sprung and damped wheels, two of them steered."),
    Example(
        "closed/four_bar.yaml",
        "Four-bar",
        "A closed loop: three links, one closure.",
        posture={"q1": 1.2, "q2": -1.0, "q3": 1.3},
    ),
    Example(
        "closed/slider_crank.yaml", "Slider-crank", "A loop through a slide.", posture={"turn": 0.9, "swing": -0.5}
    ),
    Example(
        "closed/flexible_slider_crank.yaml",
        "Flexible slider-crank",
        "A loop with a beam in it.",
    ),
    Example(
        "flexible/flexible_pendulum.yaml",
        "Flexible pendulum",
        "A beam on a hinge: shape functions, and how far the theory holds.",
        posture={"swing": 0.5},
    ),
    Example(
        "flexible/planar_robot.yaml",
        "Flexible robot",
        "Two beams, three motors behind harmonic drives, friction.",
        posture={"q1": 0.4, "q2": 0.6, "q3": -0.5},
    ),
    Example(
        "balance.yaml",
        "Balanced pole",
        "A diagram: a linear quadratic regulator holds the pole upright.",
        ("rigid/cart_pole.yaml",),
        {"q": 0.15},
    ),
    Example(
        "held_arm.yaml",
        "Held arm",
        "A diagram: a PD law and gravity compensation hold a double pendulum.",
        ("rigid/double_pendulum.yaml",),
        {"q1": -0.6, "q2": 0.9},
    ),
    Example(
        "square.yaml",
        "Flexible robot traces a square",
        "A diagram: the paper's controller of the rigid twin drives the flexible robot.",
        ("flexible/planar_robot.yaml",),
        {"q1": -0.1, "q2": 0.6, "q3": 0.3},
    ),
)


def listed() -> list[Json]:
    """The examples as the page shows them."""
    return [
        {"name": each.name, "title": each.title, "about": each.about, "kind": each.kind, "picture": each.name}
        for each in EXAMPLES
    ]


def take_example(name: str, workspace: Workspace) -> tuple[str, str]:
    """Name and text of an example's document; what a diagram reads is put into the workspace.

    Raises:
        EditError: There is none of that name.
        FileError: The workspace has another file where one that the diagram reads would go; nothing is written then.
    """
    example = next((each for each in EXAMPLES if each.name == name), None)
    if example is None:
        known = ", ".join(each.name for each in EXAMPLES)
        raise EditError("no such example", f"'{name[:50]}'", f"one of {known}", "choose one of them")
    folder = folder_of("reference_models")
    missing = {}
    for model in example.models:
        target, content = workspace.inside(model), read_text(folder / model)[0]
        if not target.exists():
            missing[target] = content
        elif read_text(target)[0] != content:
            raise FileError(
                EditError(
                    f"the example '{name}' needs '{model}'",
                    "another file of that name in this folder",
                    "an example overwrites nothing",
                    "open it in an empty folder",
                ).problem
            )
    for target, content in missing.items():
        target.parent.mkdir(parents=True, exist_ok=True)
        write(target, content)
    return example.file.rpartition("/")[2], read_text(folder / example.file)[0]
