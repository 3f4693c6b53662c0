"""Distributions: draws, densities and conjugate posteriors."""
