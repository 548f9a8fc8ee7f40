"""The local HTTP server: addresses, guard, events, and the three-dimensional viewer behind them."""
