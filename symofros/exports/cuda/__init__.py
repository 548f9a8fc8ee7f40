"""Packages of CUDA kernels."""
