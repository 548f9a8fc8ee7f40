"""The harness in continuous integration: a plug-in for pytest."""
