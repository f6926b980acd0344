"""What the benchmarks ask: one module a question."""
