"""Benchmarks of the samplers: time, memory, scaling, and what their hot kernels make of the machine."""
