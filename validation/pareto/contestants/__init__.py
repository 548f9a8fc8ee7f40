"""The contestants: our models and methods, and the engines with their own integrators."""
