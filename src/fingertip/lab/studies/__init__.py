"""Studies beside the campaign; each answers one question."""
