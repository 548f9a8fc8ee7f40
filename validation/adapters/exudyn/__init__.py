"""Exudyn: trees, loops, beams, its own solvers (github.com/jgerstm/EXUDYN)."""

from ...contract.conventions import Difference

DIFFERENCES: tuple[Difference, ...] = (
    Difference("exudyn", "coordinates", "total", "counted from the reference configuration"),
    Difference("exudyn", "bias", "h, on the left side", "-h, on the right side"),
    Difference("exudyn", "axes of a tree's joints", "any", "z of a link's frame, which is turned for it"),
    Difference(
        "exudyn", "ball and free joints, screws", "joints of a tree", "bodies with Euler parameters (w, x, y, z)"
    ),
    Difference("exudyn", "armature", "of the joint", "a mass matrix on the same coordinates"),
    Difference("exudyn-beams", "coordinates of beams", "amplitudes of shape functions", "places, slopes and rotations"),
    Difference("exudyn-beams", "length of beams' axes", "held to second order", "free, without stiffness"),
    Difference("exudyn-beams", "rotary inertia", "spins to second order", "spins of exact turns; of rods, ours too"),
)
