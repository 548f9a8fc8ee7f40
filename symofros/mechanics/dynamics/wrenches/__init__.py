"""Wrenches that joints transmit, forces inside beams, wrenches in packs."""
