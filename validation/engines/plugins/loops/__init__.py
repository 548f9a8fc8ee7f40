"""Constraints of engines that have them: one file an engine."""
