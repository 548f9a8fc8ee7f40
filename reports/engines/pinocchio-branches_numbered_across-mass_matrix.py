"""pinocchio 4.1.0: crba, branches, numbered across.

Result: M (nv, nv).
Known: none found.
"""


