"""Lagrange's equations by CasADi's automatic differentiation: the second opinion on beams.

It keeps all terms of beams, and differentiates functions stated by the user's formulas as they are; ours are
interpolated.
"""
