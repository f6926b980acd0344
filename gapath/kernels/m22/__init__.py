"""The kernels of M22: the visibility graph, operators, evolution."""
