"""What kernels keep of a genetic algorithm's course, and what is made of that."""
