"""Grid router for two layers. It made the tracks of the templates."""
