"""From pictures and grids to graphs and genotypes (M22, S04)."""
