"""An independent symbolic oracle: SymPy derives a model's equations from its description, without our recursion.

`scope` reads the description into SymPy, `elements` states the forces that act on a coordinate, `kane` derives the
equations, `compare` counts the digits that generator and oracle agree to, `models` are what it is run on.
"""
