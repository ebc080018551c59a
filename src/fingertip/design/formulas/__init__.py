"""Formulas in closed form that the rules and the board share: filter, amplifiers, supply."""
