"""Scenes and trees that cover each pair of features."""

from .scenes import COVERING as COVERING
from .scenes import mjcf as mjcf
