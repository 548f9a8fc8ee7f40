"""The paper's simulations, as diagrams: what they show, and what they cost."""
