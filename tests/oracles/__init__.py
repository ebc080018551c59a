"""Independent implementations that only tests use, to compare the product with."""
