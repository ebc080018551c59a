"""Developers' tools; they run in the repository and belong to no wheel."""

import os
from pathlib import Path

# Worker processes find the packages of the repository as this process did.
_places = [str(Path(__file__).resolve().parents[1]), os.environ.get("PYTHONPATH", "")]
os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, _places))
