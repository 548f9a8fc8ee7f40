"""Graphics processors: CUDA text compiled by NVRTC, run through the driver."""
