"""Diagrams under edit: what is drawn of one, where its faults are, its palette, renaming."""
