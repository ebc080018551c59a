"""Catalogues of what can be bought or is bundled, each figure with its source. They know no design."""
