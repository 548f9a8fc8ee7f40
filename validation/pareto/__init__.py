"""Speed against accuracy: every method and model of ours, and engines with their own integrators."""
