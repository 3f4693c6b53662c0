"""The claims of the paper, and what the results say of them."""
