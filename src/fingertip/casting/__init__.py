"""From a mold to a skin: silicones, quantities and the casting sheet."""
