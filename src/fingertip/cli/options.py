"""Arguments and options that several commands declare: one of the same name means the same in each."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fingertip.silicones import SILICONES

DesignArgument = Annotated[
    Path, typer.Argument(help="Design file, or a bundled design such as fsr400 or adult_finger.")
]
"""Design that must be named."""
OptionalDesignArgument = Annotated[
    Path | None, typer.Argument(help="Design file or bundled name; the default design if left out.")
]
"""Design that may be left out."""
MaterialOption = Annotated[
    str | None,
    typer.Option(help=f"Silicone: {', '.join(SILICONES)} or own; the design's silicone.product if omitted."),
]
"""Silicone of the skin."""
CalibratedDesignOption = Annotated[
    Path | None,
    typer.Option("--out", "-o", metavar="FILE", help="File for the calibrated design, a complete design file."),
]
"""File that a calibration writes."""
ForceCalibratedOption = Annotated[bool, typer.Option("--force", help="Overwrite FILE if it exists.")]
"""Permission to overwrite that file."""
