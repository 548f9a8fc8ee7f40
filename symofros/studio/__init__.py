"""What people look at and click on: the editor, the viewer, advice on models."""
