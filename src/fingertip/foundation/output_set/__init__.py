"""Sets of output files: written whole or not at all, and protected from being overwritten.

A set is what one command writes to a folder. Its manifest, `manifest.json`, lists the files with their hashes.

A file that the manifest does not name, or that was changed since, is somebody's own. It is never overwritten or
removed unless that is asked for.
"""

from fingertip.foundation.output_set.writer import (
    MANIFEST,
    Manifest,
    Revision,
    SetWriter,
    add_to_set,
    check_set,
    finish_interrupted,
    hash_parameters,
    read_manifest,
)

__all__ = [
    "MANIFEST",
    "Manifest",
    "Revision",
    "SetWriter",
    "add_to_set",
    "check_set",
    "finish_interrupted",
    "hash_parameters",
    "read_manifest",
]
