"""Instructions with missing, wrong, unknown or too many words, and how fits answer them."""
