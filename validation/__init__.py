"""Do independent engines agree with the generated code, how fast are they, and where do methods fail."""
