"""The document being edited: text and undo history, files, diagram, problems, and the parts that go into it."""
