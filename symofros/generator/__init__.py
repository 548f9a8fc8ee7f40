"""From programs over the expression graph to C: passes, then the emitter of C."""
