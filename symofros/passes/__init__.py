"""Program -> Program: small, named, verified."""
