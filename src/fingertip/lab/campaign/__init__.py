"""Campaign of simulated trials: plan, evaluation, the article's closed loop, and requirements."""
