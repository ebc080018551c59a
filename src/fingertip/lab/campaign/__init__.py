"""Campaign of simulated trials: plan and results, the wider mix beside them, and the article's closed loop."""
