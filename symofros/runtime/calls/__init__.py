"""Functions in memory: libraries, kernels, batches, threads."""
