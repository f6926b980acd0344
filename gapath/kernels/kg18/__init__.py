"""The kernels of KG18: B-splines, fitness, operators, evolution."""
