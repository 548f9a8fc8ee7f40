"""Open trees of rigid bodies."""
