"""Last resort of the command line: an exception that no command expected becomes one sentence and a file of details.

A traceback would end the process with the exit code of a failed check. The code here is that of an internal fault.
"""

from __future__ import annotations

import errno
import os
import sys

from fingertip._version import __version__
from fingertip.errors import FingertipError, Issue, shorten

FAULT = 70
"""Exit code of a fault of the program (`EX_SOFTWARE` of sysexits.h)."""
_MAX_REASON = 200
_MACHINE_ERRORS = frozenset({errno.EMFILE, errno.ENFILE, errno.ENOMEM})
"""Errors that blame the machine, whatever path they meet."""
_FULL_DISK = frozenset(getattr(errno, name) for name in ("ENOSPC", "EDQUOT", "EFBIG") if hasattr(errno, name))
"""Errors of a disk, which name no file when they meet one that is open."""
_REPORT = "report it, with that file, by the form for bugs of the project's issue tracker"


def describe_fault(error: BaseException) -> FingertipError:
    """Describe an unexpected exception, and write its details to a file of the folder for temporary files."""
    reason = type(error).__name__
    if text := " ".join(str(error).split()):
        reason = f"{reason}: {shorten(text, _MAX_REASON)}"
    details = _write_details(error)
    where = f"details are in {details}" if details else "no file of details could be written"
    if isinstance(error, MemoryError):
        message = f"the memory did not suffice ({reason}); close other programs, or give smaller input; {where}."
    elif isinstance(error, OSError) and error.errno in (errno.EMFILE, errno.ENFILE):
        message = f"no more files may be opened ({reason}); raise the limit, as with `ulimit -n 256`; {where}."
    else:
        message = f"stopped at a fault of its own, not at one of your input ({reason}); {where}; {_REPORT}."
    return FingertipError(Issue("fingertip", message))


def describe_path_error(error: OSError) -> FingertipError | None:
    """Describe an error of the operating system that blames a path; None if it is another one.

    A path that is too long, or a folder that may not be read, is no fault of the program, wherever it is met.
    """
    if isinstance(error, FileNotFoundError) and error.filename is None and _is_working_folder_gone():
        return FingertipError(Issue("working folder", "has been removed; change to a folder that exists."))
    if error.errno in _FULL_DISK:
        reason = error.strerror or type(error).__name__
        place = str(error.filename or "disk")
        message = f"cannot be written ({reason}); free some space there, and in TMPDIR."
        return FingertipError(Issue(place, message))
    if error.filename is None or error.errno in _MACHINE_ERRORS:
        return None
    path = os.fsdecode(error.filename) if isinstance(error.filename, str | bytes) else str(error.filename)
    reason = error.strerror or type(error).__name__
    return FingertipError(Issue(path, f"cannot be used ({reason}); give another path, or change its mode."))


def _is_working_folder_gone() -> bool:
    try:
        os.getcwd()
    except OSError:
        return True
    return False


def _write_details(error: BaseException) -> str | None:
    """Write command, versions and traceback to a new file; return its path, or None if that fails."""
    try:
        import platform
        import tempfile
        import traceback

        trace = "".join(traceback.format_exception(error))
        lines = [
            f"fingertip {__version__}, Python {platform.python_version()}, {platform.system()} {platform.machine()}",
            f"command: {shorten(repr(sys.argv[1:]), 4000)}",
            shorten(trace, 100_000),
        ]
        handle, path = tempfile.mkstemp(prefix="fingertip-fault-", suffix=".txt")
        with os.fdopen(handle, "w", encoding="utf-8", errors="backslashreplace") as file:
            file.write("\n".join(lines))
    except Exception:  # no memory, no file handle, no such folder: the sentence alone must do
        return None
    return path
