"""What each part is, as an expression; and which parts a design has."""
