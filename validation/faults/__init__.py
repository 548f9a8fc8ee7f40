"""Real faults: wrong numbers of public releases of engines, each with a script and the right value."""
