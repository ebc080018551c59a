"""Documents of the board: README of its folder, and bring-up sheet."""
