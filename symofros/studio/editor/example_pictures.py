"""`python -m symofros.studio.editor.example_pictures`: the pictures of the examples, anew, into the page's source."""

from __future__ import annotations

from pathlib import Path

from PIL import Image

import symofros as sf
from symofros.harness import folder_of
from symofros.studio.editor.document.examples import EXAMPLES, Example

FOLDER = Path(__file__).parent / "page" / "public" / "examples"
SIZE = (240, 160)


def picture(example: Example, file: Path) -> None:
    """Draw an example's mechanism in its posture: of a diagram, the first model that it reads."""
    models = folder_of("reference_models")
    system = sf.load(models / (example.models[0] if example.models else example.file))
    model = sf.compile(system)
    q = model.neutral()
    for name, value in example.posture.items():
        q[model.names.q.index(name)] = value
    if model.nc:  # The rest is a guess.
        q = sf.assemble(model, q, held=[*example.posture][:1]).q
    # Drawn at twice the size: lines of one pixel are then those of a picture, not of a sketch.
    sf.record(system, ([0.0], [q]), file, size=(2 * SIZE[0], 2 * SIZE[1]))
    image = Image.open(file).convert("RGB").resize(SIZE, Image.Resampling.LANCZOS)
    image.quantize(64, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE).save(file, optimize=True)


def main() -> None:
    """Draw all of them."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    for example in EXAMPLES:
        picture(example, FOLDER / f"{example.name}.png")
        print(example.name)


if __name__ == "__main__":
    main()
