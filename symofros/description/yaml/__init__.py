"""The native file: YAML in and out, its schema, its faults."""
