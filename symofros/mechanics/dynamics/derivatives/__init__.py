"""Derivatives of the equations: by differentiation of the graph, and of rigid trees by recursion."""
