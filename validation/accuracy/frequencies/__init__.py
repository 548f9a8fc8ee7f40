"""Frequencies of beams at rest and in steady spin: convergence, conditioning, stiffening."""
