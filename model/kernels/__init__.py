"""The compiled parts of the samplers."""
