"""A mechanism in three dimensions: what to draw, a viewer in the browser, pictures and recordings (docs/view.md)."""
