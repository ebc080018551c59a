"""Bundled designs, sets, scenes and sweeps: the files of `params/`, which are found by bare name.

A bare name is a single word without suffix and slash, such as fsr400. An existing path of the same name comes first.
The wheel holds `params/` within the package. In a checkout it stands at the top level, beside `src/`.
"""

from __future__ import annotations

import difflib
import os
import re
from collections.abc import Sequence
from pathlib import Path

from fingertip.catalogues.file_kinds import FileKind, identify_kind
from fingertip.foundation.errors import Issue, TomlFileError, join_words

_IN_WHEEL = Path(__file__).parents[1] / "params"
_IN_CHECKOUT = Path(__file__).parents[3] / "params"
PARAMS = _IN_WHEEL if _IN_WHEEL.is_dir() else _IN_CHECKOUT
_FOLDERS = ("", "scenes", "sets", "surfaces", "sweeps")
_BARE_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_-]*")
_MAX_SUGGESTIONS = 3


def list_bundled_files(*kinds: FileKind) -> dict[str, Path]:
    """List the bundled files of some kinds, or of all kinds, by bare name. No two files have the same name."""
    files = {path.stem: path for folder in _FOLDERS for path in sorted((PARAMS / folder).glob("*.toml"))}
    return {name: path for name, path in files.items() if not kinds or identify_kind(path) in kinds}


def find_file(given: str | Path, *kinds: FileKind, folder: Path | None = None) -> Path:
    """Find a file that is given by path or by bare name. Raises TomlFileError."""
    name, path = str(given), (folder or Path()) / given
    if not _BARE_NAME.fullmatch(name):
        return path
    bundled, wanted = list_bundled_files().get(name), join_words((kind.describe() for kind in kinds), "or")
    if os.path.exists(path):  # false for a name that is too long to be one, where Path.exists raises
        if bundled and path.is_dir():
            problem = "is a folder, which comes before the bundled file of the same name"
            raise TomlFileError(Issue(name, f"{problem}; run this in another folder, or give the path of {wanted}."))
        return path
    kind = identify_kind(bundled) if bundled else None
    if bundled and kind in kinds:
        return bundled
    known = list(list_bundled_files(*kinds))
    if kind is None:
        raise TomlFileError(Issue(name, _describe_unknown(name, path, kinds, known)))
    remedy = f"known names: {', '.join(known)} ({kind.use})"
    raise TomlFileError(Issue(name, f"is {kind.describe()}, not {wanted}; {remedy}."))


def _describe_unknown(name: str, path: Path, kinds: Sequence[FileKind], known: Sequence[str]) -> str:
    """Describe a bare name that nothing has, with close names, or else with all of them."""
    close = difflib.get_close_matches(name, known, n=_MAX_SUGGESTIONS)
    similar = [other for other in known if other in close]
    if os.path.isfile(path.with_name(f"{name}.toml")):
        similar.insert(0, f"{name}.toml")
    remedy = f"known names: {', '.join(known)}; or give the path of a file." if known else "give the path of a file."
    if similar:
        remedy = f"did you mean {join_words(similar, 'or')}?"
    wanted = join_words((kind.name for kind in kinds), "or")
    return f"is neither a file nor the name of a bundled {wanted}; {remedy}"
