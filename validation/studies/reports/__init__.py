"""The reports of studies: what is measured, and what is said of it."""
