"""Claims of files of arrays: how much a library would unpack or list, found before it does so.

References: National Instruments, "TDMS File Format Internal Structure"; MathWorks, "MAT-File Format", Level 5.
"""

from __future__ import annotations

import os
import struct
import zlib
from typing import BinaryIO

from fingertip.slip.traces.limits import max_table_bytes

MAX_SEGMENTS = 100_000
"""Maximum number of segments of a TDMS file. A converter that streams writes some a second."""
MAX_METADATA_BYTES = 16 * 2**20
"""Maximum size of the names and properties of a TDMS file [bytes]."""
_LEAD_IN = struct.Struct("<4sIIQQ")
_UNFINISHED = 2**64 - 1
"""Length of the last segment of a recording that was interrupted."""
_COMPRESSED = 15
"""Type of a variable of a MATLAB file that is compressed."""
_PIECE_BYTES = 2**20


def check_tdms_segments(file: BinaryIO) -> None:
    """Walk over the segments of a TDMS file.

    Raises
    ------
    ValueError
        If it has more segments, or more names and properties, than a recording has.
    """
    size, place, count, metadata = file.seek(0, os.SEEK_END), 0, 0, 0
    while place + _LEAD_IN.size <= size:
        file.seek(place)
        tag, _, _, length, raw_at = _LEAD_IN.unpack(file.read(_LEAD_IN.size))
        if tag != b"TDSm":
            break  # the library says what is wrong
        count += 1
        metadata += min(raw_at, size - place)
        if count > MAX_SEGMENTS or metadata > MAX_METADATA_BYTES:
            raise ValueError(f"it has {count} segments or more, with {metadata} bytes of names and properties")
        if length == _UNFINISHED:
            break
        place += _LEAD_IN.size + length
    file.seek(0)


def check_mat_variables(file: BinaryIO) -> None:
    """Unpack the compressed variables of a MATLAB file piece by piece, keeping none.

    Raises
    ------
    ValueError
        If they unpack to more than the largest table.
    zlib.error
        If one is damaged.
    """
    header = file.read(128)
    order = ">" if header[126:128] == b"MI" else "<"
    left = max_table_bytes()
    while len(tag := file.read(8)) == 8:
        kind, length = struct.unpack(f"{order}II", tag)
        end = file.tell() + length
        unpacker = zlib.decompressobj()
        while kind == _COMPRESSED and file.tell() < end and not unpacker.eof:
            piece = file.read(min(_PIECE_BYTES, end - file.tell()))
            while piece:
                left -= len(unpacker.decompress(piece, _PIECE_BYTES))
                if left < 0:
                    raise ValueError(f"its variables unpack to more than {max_table_bytes() / 2**20:.0f} MB")
                piece = unpacker.unconsumed_tail
            if file.tell() >= os.fstat(file.fileno()).st_size:
                break
        file.seek(end)
    file.seek(0)
