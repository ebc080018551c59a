"""A figure of the article: the picture of its simulated counterpart, and statements beside it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any


@dataclass(frozen=True)
class Statement:
    """What the article says, and what is found here."""

    article: str
    here: str
    agrees: bool | None
    """None: in part."""


@dataclass(frozen=True, eq=False)
class Figure:
    file: str
    title: str
    """Number of the article's figure, and its subject."""
    caption: str
    """What the picture shows."""
    picture: bytes
    statements: tuple[Statement, ...]

    def as_data(self) -> Mapping[str, Any]:
        """Return all but the picture."""
        return {
            "file": self.file,
            "title": self.title,
            "caption": self.caption,
            "statements": list(map(asdict, self.statements)),
        }
