"""The editor: a local page that draws, edits, checks, compiles and simulates a mechanism (docs/editor.md)."""
