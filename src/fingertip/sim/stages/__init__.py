"""What a scene needs is computed and nothing else: stages, their order, the result."""
