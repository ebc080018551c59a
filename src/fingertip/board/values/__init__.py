"""Component values of the board: formulas, preferred values, and the resulting response, noise and limits."""
