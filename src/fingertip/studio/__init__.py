"""Studio: a local page with a form of a design's parameters, whose parts are redrawn while somebody moves a slider."""

DEFAULT_PORT = 8350
"""Port at which the page is served unless another one is named."""
