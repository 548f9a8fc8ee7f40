"""What engines and the harness agree on: the interface, signs and orders, what is computed and how closely."""
