"""An independent symbolic oracle: SymPy derives a model from its description, twice, and neither shares our recursion.

`scope` reads the description into SymPy, `elements` states the forces that act on a coordinate, `lagrange` and `kane`
derive the equations, `compare` counts the digits that generator and oracle agree to, `models` are what it is run on.
"""
