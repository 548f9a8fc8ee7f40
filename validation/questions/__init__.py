"""Reports of one kind: questions, each answered in words, figures and numbers with bounds."""
