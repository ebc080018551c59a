"""Kinds of files, known by their first bytes: how each is read, or the sentence that says how to convert it."""

from __future__ import annotations

import struct
import zipfile
from pathlib import Path

from fingertip.input_files import check_archive

_HDF5 = (
    "is an HDF5 file, as MATLAB saves with -v7.3; in MATLAB save it with -v7, or in Python with numpy.savez(file, "
    "time_s=..., voltage_v=...)."
)
_WORKBOOK = "is a workbook of a spreadsheet; save its sheet as CSV."
_ROS1 = "is a bag of ROS 1; convert one topic to CSV with `rostopic echo -b FILE -p /topic > trace.csv`."
_ROS2 = (
    "is a bag of ROS 2; play it with `ros2 bag play FILE`, and save one topic with "
    "`ros2 topic echo --csv /topic > trace.csv`."
)
_COMPRESSED = "is compressed; unpack it first, and give the trace inside."
_PICKLE = "is a pickle, which may run programs when it is read; save numbers with numpy.savez."

READABLE = ("npz", "npy", "tdms", "mat", "parquet", "wav")
"""Kinds of files besides CSV that are read."""
_SIGNATURES = (
    (b"\x93NUMPY", "npy"),
    (b"TDSm", "tdms"),
    (b"MATLAB 7.3 MAT-file", _HDF5),
    (b"MATLAB 5.0 MAT-file", "mat"),
    (b"PAR1", "parquet"),
    (b"\x89HDF\r\n\x1a\n", _HDF5),
    (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", _WORKBOOK),
    (b"#ROSBAG V", _ROS1),
    (b"SQLite format 3\0", _ROS2),
    (b"\x89MCAP", _ROS2),
    (b"ARROW1", "is an Arrow or Feather file; save it as Parquet or CSV."),
    (b"\x1f\x8b", _COMPRESSED),
    (b"BZh", _COMPRESSED),
    (b"\xfd7zXZ\0", _COMPRESSED),
    (b"7z\xbc\xaf\x27\x1c", _COMPRESSED),
    (b"Rar!", _COMPRESSED),
    (b"\x28\xb5\x2f\xfd", _COMPRESSED),
    (b"\x80\x03", _PICKLE),
    (b"\x80\x04", _PICKLE),
    (b"\x80\x05", _PICKLE),
    (b"%PDF", "is a PDF; export the recording as CSV."),
    (b"\x89PNG", "is a picture; export the recording as CSV."),
)
"""First bytes -> kind of file, or how to convert it."""
_ENDINGS = {
    ".xlsx": _WORKBOOK, ".xls": _WORKBOOK, ".ods": _WORKBOOK, ".bag": _ROS1, ".mcap": _ROS2, ".db3": _ROS2,
    ".h5": _HDF5, ".hdf5": _HDF5, ".pkl": _PICKLE, ".pickle": _PICKLE,
    ".json": "is a JSON file; convert it to CSV with the columns time_s,voltage_v.",
}  # fmt: skip
"""Endings of names -> how to convert such a file, if its first bytes are unknown."""
_HEAD_BYTES = 64


def identify(path: Path) -> str:
    """Return the kind of a file from `READABLE`, a sentence that says how to convert it, or "csv".

    Raises
    ------
    OSError
        If the file cannot be read.
    """
    with path.open("rb") as file:
        head = file.read(_HEAD_BYTES)
    for signature, kind in _SIGNATURES:
        if head.startswith(signature):
            return kind
    if head.startswith(b"RIFF") and head[8:12] == b"WAVE":
        return "wav"
    if head.startswith(b"PK\x03\x04"):
        return _identify_zip(path)
    suffix = path.suffix.lower()
    if suffix.lstrip(".") in READABLE:
        return suffix.lstrip(".")
    return _ENDINGS.get(suffix, "csv")


def _identify_zip(path: Path) -> str:
    """Return the kind of a ZIP archive, by the names in it; of a damaged one, by its own name."""
    try:
        with path.open("rb") as file:
            check_archive(file)
            names = zipfile.ZipFile(file).namelist()
    except (zipfile.BadZipFile, ValueError, NotImplementedError, struct.error):
        return _ENDINGS.get(path.suffix.lower(), "npz")
    if any(name.startswith("xl/") or name == "content.xml" for name in names):
        return _WORKBOOK
    return "npz" if path.suffix.lower() == ".npz" or any(name.endswith(".npy") for name in names) else _COMPRESSED
