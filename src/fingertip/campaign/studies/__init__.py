"""Studies beside the campaign: one question each."""
