"""Parts that go into a document: templates of the palette, and those that a user keeps."""
