"""Models in JAX, PyTorch, CasADi and WebAssembly: their numbers beside native C, their times beside a peer's."""
