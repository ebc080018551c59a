"""Gate for files that are read: regular files of a bounded size, and safe names.

Every file that a user names, or that lies in a folder that a user names, is opened here or checked
here before a library opens it. A device, a pipe or a socket is refused without being opened: it may
never end. The limits may be raised by environment variables, for files that are large on purpose.

A folder may come from a stranger. A caller that reads a file in it gives the folder as `below`:
then no link is followed, and every name on the way from that folder to the file is that of a file
or folder within it.
"""

from __future__ import annotations

import contextlib
import os
import stat
import unicodedata
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from io import BufferedReader
from pathlib import Path
from typing import TypeGuard

from fingertip.foundation.errors import InputFileError, Issue, escape_control, quote_value

_MEGABYTE = 2**20


@dataclass(frozen=True)
class Limit:
    """Largest number that is accepted, which an environment variable may replace."""

    variable: str
    default: int
    unit: int
    """Size of one unit of the variable: bytes in a megabyte, or 1."""
    unit_name: str = ""

    @property
    def value(self) -> int:
        """The limit that applies. Raises InputFileError."""
        text = os.environ.get(self.variable, "")
        if not text:
            return self.default * self.unit

        if not (text.isascii() and text.isdecimal() and len(text) <= 12 and int(text) > 0):
            unit = f" of {self.unit_name}" if self.unit_name else ""
            message = (
                f"{quote_value(text)} is no limit; set it to a whole number{unit} above 0, "
                "or unset it."
            )
            raise InputFileError(Issue(self.variable, message))

        return int(text) * self.unit


TOML_LIMIT = Limit("FINGERTIP_MAX_TOML_MB", 1, _MEGABYTE, "MB")
RECORDING_LIMIT = Limit("FINGERTIP_MAX_RECORDING_MB", 1024, _MEGABYTE, "MB")
"""Largest recording, and largest array within it [bytes]."""
SAMPLES_LIMIT = Limit("FINGERTIP_MAX_SAMPLES", 2**23, 1, "samples")
"""Largest number of samples of a recording. Each takes some 75 bytes of memory."""
OUTPUT_LIMIT = Limit("FINGERTIP_MAX_OUTPUT_MB", 256, _MEGABYTE, "MB")
"""Largest file of an output folder that is read back [bytes]."""
PARSED_LIMIT = Limit("FINGERTIP_MAX_PARSED_MB", 16, _MEGABYTE, "MB")
"""Largest file of an output folder that is parsed, such as a manifest [bytes].
It takes many times that in memory.
"""
BODY_LIMIT = Limit("FINGERTIP_MAX_BODY_MB", 32, _MEGABYTE, "MB")
"""Largest STEP or STL file of a body that another program has drawn [bytes]."""
_SEPARATORS = frozenset('/\\:*?"<>|')
"""Characters that separate the names of a path on some system, or that Windows reserves."""
_PORT_NUMBERS = "123456789\xb9\xb2\xb3"
_DEVICES = frozenset(
    {
        *("CON", "PRN", "AUX", "NUL", "CONIN$", "CONOUT$"),
        *(f"COM{number}" for number in _PORT_NUMBERS),
        *(f"LPT{number}" for number in _PORT_NUMBERS),
    }
)
"""Names that are devices on Windows, whatever their ending."""
_MAX_NAME_BYTES = 240
"""Maximum length of a name. File systems take 255 bytes, and a temporary name has a prefix."""
_KINDS = {
    stat.S_IFLNK: "a link",
    stat.S_IFDIR: "a folder",
    stat.S_IFIFO: "a pipe",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}


def is_safe_name(name: object) -> TypeGuard[str]:
    """Return whether a value names one file in a folder on every system.

    Names of temporary files are not safe.
    """
    return (
        isinstance(name, str)
        and escape_control(name) == name
        and not _SEPARATORS.intersection(name)
        and 0 < len(name.encode()) <= _MAX_NAME_BYTES
        and name[-1] not in ". "  # Windows leaves them out
        and name.partition(".")[0].rstrip().upper() not in _DEVICES
        and not name.casefold().startswith(".fingertip")
    )


def find_unsafe_names(names: Iterable[object]) -> list[object]:
    """Find the names that are not safe, or differ from an earlier one by case alone."""
    seen = {""}
    unsafe = []

    for name in names:
        folded = unicodedata.normalize("NFD", name).casefold() if is_safe_name(name) else ""
        if folded in seen:
            unsafe.append(name)

        seen.add(folded)

    return unsafe


def find_link(folder: Path, path: Path) -> Path | None:
    """Find the first link between a folder and a path below it, which may be the link; or None."""
    steps = [path, *path.parents][: len(path.relative_to(folder).parts)]
    return next((step for step in reversed(steps) if step.is_symlink()), None)


def check_regular(
    path: Path, limit: Limit | None = None, wanted: str = "a file", below: Path | None = None
) -> int:
    """Check that a path names a regular file within a limit, and return its size [bytes].

    Raises InputFileError.
    """
    try:
        return _check_status(path, _read_status(path, below), limit, _remedy(wanted, below))
    except (OSError, ValueError) as error:
        raise _unreadable(path, error, _remedy(wanted, below)) from None


@contextlib.contextmanager
def open_input(
    path: Path, limit: Limit, wanted: str = "a file", below: Path | None = None
) -> Iterator[BufferedReader]:
    """Open a regular file to read; parameters and exceptions are those of `check_regular`."""
    remedy = _remedy(wanted, below)
    try:
        _check_status(path, _read_status(path, below), limit, remedy)
        file = path.open("rb")
    except (OSError, ValueError) as error:
        raise _unreadable(path, error, remedy) from None

    with file:
        try:
            yield file
        except OSError as error:
            if error.filename is not None:  # it is of another file: those of reading name none
                raise

            raise _unreadable(path, error, remedy) from None


def read_input(
    path: Path,
    limit: Limit,
    wanted: str = "a file",
    length: int | None = None,
    below: Path | None = None,
) -> bytes:
    """Read a regular file or its first `length` bytes; else as `check_regular`.

    Raises InputFileError.
    """
    with open_input(path, limit, wanted, below) as file:
        data = file.read(limit.value + 1 if length is None else length)

    if len(data) > limit.value:  # it grows, or is one of the system's files that state no size
        raise _too_large(path, len(data), limit)

    return data


def _read_status(path: Path, below: Path | None) -> os.stat_result:
    """Read the status of a file, without leaving the folder `below`, which may be a stranger's."""
    if below is None:
        return os.stat(path)

    names = path.relative_to(below).parts if path.is_relative_to(below) else ()
    if not (names and all(is_safe_name(name) for name in names)):
        raise InputFileError(Issue(str(path), f"is no name of a file in {below}; rename it."))

    return os.lstat(find_link(below, path) or path)


def _remedy(wanted: str, below: Path | None) -> str:
    return f"give the path of {wanted}." if below is None else "put a file in its place."


def _check_status(path: Path, status: os.stat_result, limit: Limit | None, remedy: str) -> int:
    if not stat.S_ISREG(status.st_mode):
        kind = _KINDS.get(stat.S_IFMT(status.st_mode), "no regular file")
        raise InputFileError(Issue(str(path), f"is {kind}, not a regular file; {remedy}"))

    if limit is not None and status.st_size > limit.value:
        raise _too_large(path, status.st_size, limit)

    return status.st_size


def _unreadable(path: Path, error: OSError | ValueError, remedy: str) -> InputFileError:
    reason = "its path holds a NUL character"
    if isinstance(error, OSError):
        reason = error.strerror or str(error)

    return InputFileError(Issue(str(path), f"cannot be read ({reason}); {remedy}"))


def _too_large(path: Path, size: int, limit: Limit) -> InputFileError:
    message = (
        f"has {size / _MEGABYTE:.4g} MB or more; at most {limit.value / _MEGABYTE:.4g} MB are "
        f"read; make it smaller, or raise {limit.variable}."
    )
    return InputFileError(Issue(str(path), message))
