"""Motions over time: read from runs and files, played by the clock; sliders for one configuration."""
