"""Rules between parameters, by what they are about, and the engine that checks them."""
