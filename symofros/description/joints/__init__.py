"""Joints and their kinds."""
