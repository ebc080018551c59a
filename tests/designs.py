"""Designs that several tests compare: the article's circuit and converter, and a board for a controller."""

from __future__ import annotations

from fingertip.design import Design

ARTICLE = Design.load("article")
"""The article's board, supply and converter, with the default finger."""
