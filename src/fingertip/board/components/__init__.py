"""Selection of the board's components: preferred values for a design, and data of the amplifiers."""
