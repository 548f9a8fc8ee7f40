"""A figure that a notebook shows; imported when one is drawn, because Matplotlib is an extra (`plots`)."""

from __future__ import annotations

from io import BytesIO

from matplotlib.figure import Figure


class NotebookFigure(Figure):
    """Matplotlib's Figure without a window, which notebooks would otherwise name and not show."""

    def _repr_png_(self) -> bytes:
        picture = BytesIO()
        self.savefig(picture, format="png", dpi=100)
        return picture.getvalue()
