"""Program -> C text. Knows no mechanics."""
