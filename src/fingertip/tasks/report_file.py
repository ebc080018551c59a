"""Reader of `report.json` and other JSON files in a folder of unknown origin."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from fingertip.foundation.errors import InputFileError, Issue
from fingertip.foundation.input_files import PARSED_LIMIT, read_input


def read_json_file(path: Path, below: Path) -> dict[str, Any]:
    """Read a JSON object of a folder. Raises InputFileError if the file holds anything else."""
    try:
        data = json.loads(read_input(path, PARSED_LIMIT, below=below))
    except (ValueError, RecursionError):
        data = None

    if not isinstance(data, dict):
        raise InputFileError(
            Issue(str(path), "is not a report of fingertip; make the design there again.")
        )

    return data
