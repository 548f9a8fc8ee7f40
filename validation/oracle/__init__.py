"""An independent symbolic oracle: SymPy derives a model from its description and shares nothing of our recursion.

`scope` reads the description into SymPy, `elements` states the forces that act on a coordinate, `kane` derives the
equations, `compare` counts the digits that generator and oracle agree to, `models` are what it is run on.
"""
