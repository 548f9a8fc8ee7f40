"""Lagrange's equations by CasADi's automatic differentiation: the second opinion on beams."""
