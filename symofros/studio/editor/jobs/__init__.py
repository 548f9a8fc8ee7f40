"""Long operations (compile, cross-check, simulate, export, import) in worker processes."""
