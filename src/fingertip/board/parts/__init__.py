"""Parts of a board as data: components, pins and nets, symbols, and what can be bought."""
