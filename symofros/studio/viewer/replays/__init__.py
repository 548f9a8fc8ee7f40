"""Replays: pages that play a motion by themselves, and simulate on from it."""
