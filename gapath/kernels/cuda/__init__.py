"""Kernels for CUDA GPUs: KG18's evolution, a run a thread, with the processor's own kernels."""
