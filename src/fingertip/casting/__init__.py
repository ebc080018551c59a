"""Casting of the skin: silicones, quantities to mix, hardware to buy and the casting sheet."""
