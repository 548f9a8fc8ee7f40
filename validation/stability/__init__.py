"""Where simulations fail: maps over two parameters, one module a scene or a few related ones."""
