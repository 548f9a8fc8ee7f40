"""The sides of a race as loops in C: ours, engines, other generators."""
