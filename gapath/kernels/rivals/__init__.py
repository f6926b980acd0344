"""The kernels of other families' planners: jump points, any angle, random trees."""
