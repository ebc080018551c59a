"""Proof that the parts are what was designed: identities, measures, and all checks of a design."""
