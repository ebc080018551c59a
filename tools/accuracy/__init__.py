"""Page docs/accuracy.md, made by one command."""
