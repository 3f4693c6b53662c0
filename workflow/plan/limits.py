"""What is read at most of a stranger's config, and run because of it."""

MAX_CONFIG_BYTES = 250_000
"""Size of a config file; the largest vocabulary that is allowed fits."""
MAX_CONFIG_VALUES = 20_000
"""Values in a config file: scalars, lists and mappings."""
MAX_NUMBER_LENGTH = 100
"""Characters of a number in a config file."""
MAX_FITS = 100_000
"""Fits, and jobs that simulate, of one experiment."""
