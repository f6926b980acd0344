"""The kernels of S04: row- and column-wise chromosomes, operators, evolution, reach."""
