"""What a check found, for people and programs: the terminal, pages, summaries, JSON, JUnit."""
