"""Equal limbs in C: what a function computes for each of them, as vectors with a lane a limb.

A leg's equations are those of the other legs, with other joints and other numbers (docs/theory/code.md, section 10).
Which nodes correspond is found by `counterparts`, by which sign a lane holds its node by `signs`; `plan` forms the
vectors, `vector` writes them.
"""
