"""Mechanisms with closed loops and conditions on speeds."""
