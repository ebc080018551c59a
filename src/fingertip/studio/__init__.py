"""Studio: a local page with a form of a design's parameters, whose parts are redrawn while somebody moves a slider."""
