"""CasADi: recursive dynamics in its scalars, and the C that it makes of them (web.casadi.org)."""
