"""Conditions on configuration and speeds, and the wrenches that keep them."""
