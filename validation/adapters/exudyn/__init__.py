"""Exudyn: trees, loops, beams, its own solvers (github.com/jgerstm/EXUDYN).

Beyond the conventions that its plug-ins state: the elements of `exudyn-beams` have places, slopes and rotations as
coordinates, axes whose length is free but without stiffness, and the rotary inertia of exact turns
(docs/theory/elements.md).
"""
