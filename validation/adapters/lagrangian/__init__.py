"""Lagrange's equations by CasADi's automatic differentiation: the second opinion on beams."""

from ...contract.conventions import Difference

DIFFERENCES = (
    Difference("lagrangian", "terms of beams", "up to the order described", "all: compared with our model of all"),
    Difference("lagrangian", "functions stated by the user's formulas", "interpolated", "differentiated as they are"),
)
