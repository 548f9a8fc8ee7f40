"""Where simulations fail: maps over two parameters, one module a study or a few related ones."""
