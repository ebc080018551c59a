"""Trace files that hold arrays: NumPy, MATLAB, Parquet, WAV and TDMS.

Every array is measured by its header before it is read, and only those are read that a trace takes.
"""

from __future__ import annotations

import contextlib
import os
import struct
import wave
import zipfile
import zlib
from collections.abc import Callable, Collection, Iterator, Mapping
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from fingertip.foundation import extras
from fingertip.foundation.errors import FingertipError, Issue, TraceError, shorten
from fingertip.foundation.input_files import RECORDING_LIMIT, check_archive, check_member
from fingertip.slip.traces.trace import BOARD_COLUMNS, COLUMNS, ColumnMap, max_table_bytes, shape_message

# Claims of files of arrays: how much a library would unpack or list, found before it does so.
#
# References: National Instruments, "TDMS File Format Internal Structure"; MathWorks, "MAT-File Format", Level 5.

MAX_SEGMENTS = 100_000
"""Maximum number of segments of a TDMS file. A converter that streams writes some a second."""
MAX_METADATA_BYTES = 16 * 2**20
"""Maximum size of the names and properties of a TDMS file [bytes]."""
_LEAD_IN = struct.Struct("<4sIIQQ")
_UNFINISHED = 2**64 - 1
"""Length of the last segment of a recording that was interrupted."""
_COMPRESSED = 15
_PIECE_BYTES = 2**20


def check_tdms_segments(file: BinaryIO) -> None:
    """Walk over the segments of a TDMS file. Raises ValueError."""
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
    """Unpack the compressed variables of a MATLAB file piece by piece, keeping none. Raises ValueError or error."""
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


RATE = "sample_rate_hz"
"""Name of a number in a file that replaces its times."""
_MAX_REASON = 200
"""Maximum length of the reason that a library gives, which may repeat bytes of the file [characters]."""
AS_CSV = "save the recording as CSV"
_WAV_FULL_SCALE = {1: 128.0, 2: 2.0**15, 3: 2.0**23, 4: 2.0**31}
"""Bytes of a sample -> its full scale."""


@contextlib.contextmanager
def _damage_reported(path: Path, kind: str, remedy: str) -> Iterator[None]:
    """Turn any exception of a library that reads a file into one sentence: a damaged file may raise any."""
    try:
        yield
    except (FingertipError, FileNotFoundError, PermissionError):
        raise
    except Exception as error:
        reason = shorten(" ".join(str(error).split()) or type(error).__name__, _MAX_REASON)
        message = f"is not {kind} that can be read ({reason}); {remedy}."
        raise TraceError(Issue(str(path), message)) from None


def _wanted(columns: ColumnMap) -> set[str]:
    return {*map(columns.name_in_file, COLUMNS), *(f"sampled_{column}" for column in BOARD_COLUMNS), RATE}


def _skip_others(names: Collection[str], load: Callable[[str], Any], columns: ColumnMap) -> dict[str, Any]:
    wanted = _wanted(columns)
    return {name: load(name) if name in wanted else None for name in names}


def _check_shape(path: Path, name: str, shape: tuple[int, ...], item_bytes: int = 8) -> None:
    if message := shape_message(shape, item_bytes):
        raise TraceError(Issue(f"{path}, {name}" if name else str(path), message))


def _load_npy(path: Path, columns: ColumnMap) -> Mapping[str, Any]:
    with _damage_reported(path, "a NumPy file", "save numbers with numpy.savez"), path.open("rb") as file:
        shape, dtype = _read_npy_header(file)
        _check_shape(path, "", shape, dtype.itemsize)
        array = np.load(path, allow_pickle=False)
    if array.dtype.names:
        return {name: array[name] for name in array.dtype.names}
    return _name_columns(path, array, columns)


def _name_columns(path: Path, array: NDArray[Any], columns: ColumnMap) -> Mapping[str, Any]:
    """Name the columns of an array without names: the voltage alone, time and voltage, or all by number."""
    voltage, time = columns.name_in_file("voltage_v"), columns.name_in_file("time_s")
    if array.ndim == 2 and 1 in array.shape:
        array = array.ravel()
    if array.ndim == 1:
        return {voltage: array}
    if array.ndim == 2 and (voltage.isdecimal() or time.isdecimal()):
        return {str(number): column for number, column in enumerate(array.T, 1)}
    if array.ndim == 2 and array.shape[1] == 2:
        # The columns of an array have no names: a name for the time (`--column time_s=none`) means to ignore it.
        if columns.rate_hz is not None and "time_s" in columns.names:
            return {voltage: array[:, 1]}
        return {time: array[:, 0], voltage: array[:, 1]}
    message = (
        f"has shape {array.shape}; give (samples,) with --rate-hz, (samples, 2) for time and voltage, or choose "
        "columns by number, such as --column time_s=1 --column voltage_v=2."
    )
    raise TraceError(Issue(str(path), message))


def _load_npz(path: Path, columns: ColumnMap) -> Mapping[str, Any]:
    def load(name: str) -> Any:
        check_member(archive.getinfo(members[name]))
        with archive.open(members[name]) as member:
            shape, dtype = _read_npy_header(member)
        _check_shape(path, name, shape, dtype.itemsize)
        with archive.open(members[name]) as member:
            return np.lib.format.read_array(member, allow_pickle=False)

    with (
        _damage_reported(path, "a NumPy archive", "save numbers with numpy.savez, without a password"),
        path.open("rb") as file,
    ):
        check_archive(file)
        archive = zipfile.ZipFile(file)
        members = {name.removesuffix(".npy"): name for name in archive.namelist()}
        return _skip_others(members, load, columns)


def _read_npy_header(file: Any) -> tuple[tuple[int, ...], np.dtype[Any]]:
    version = np.lib.format.read_magic(file)
    read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, _, dtype = read(file)
    if dtype.hasobject:
        raise ValueError("it holds objects, which only pickle reads")
    return shape, dtype


def _load_mat(path: Path, columns: ColumnMap) -> Mapping[str, Any]:
    scipy_io = extras.load("scipy.io", str(path), alternative=AS_CSV)
    with _damage_reported(path, "a MATLAB file", "save it with -v7, or as CSV"):
        with path.open("rb") as file:
            check_mat_variables(file)
        shapes = {name: shape for name, shape, _ in scipy_io.whosmat(path)}
        needed = [name for name in shapes if name in _wanted(columns)]
        for name in needed:
            _check_shape(path, name, shapes[name])
        loaded = scipy_io.loadmat(path, variable_names=needed) if needed else {}
        return {name: loaded[name] if name in needed else None for name in shapes}


def _load_parquet(path: Path, columns: ColumnMap) -> Mapping[str, Any]:
    parquet = extras.load("pyarrow.parquet", str(path), alternative=AS_CSV)
    with _damage_reported(path, "a Parquet file", "save it again, or as CSV"), parquet.ParquetFile(path) as file:
        _check_shape(path, "", (file.metadata.num_rows,))
        groups = (file.metadata.row_group(number) for number in range(file.metadata.num_row_groups))
        if (unpacked := sum(group.total_byte_size for group in groups)) > RECORDING_LIMIT.value:
            raise ValueError(f"it unpacks to {unpacked / 2**20:.0f} MB")
        names = list(file.schema_arrow.names)
        needed = [name for name in names if name in _wanted(columns)]
        parts: dict[str, list[Any]] = {name: [] for name in needed}
        count = 0
        for batch in file.iter_batches(columns=needed) if needed else ():
            count += len(batch)
            _check_shape(path, "", (count,))
            for name in needed:
                parts[name].append(batch.column(name).to_numpy(zero_copy_only=False))
        return {name: (np.concatenate(parts[name]) if parts.get(name) else None) for name in names}


def _load_wav(path: Path, columns: ColumnMap) -> Mapping[str, Any]:
    with (
        _damage_reported(path, "a WAV file", "save it as PCM of 16 or 24 bits, or as CSV"),
        path.open("rb") as file,
        wave.open(file) as recording,
    ):
        channels, width = recording.getnchannels(), recording.getsampwidth()
        frames = min(recording.getnframes(), path.stat().st_size // max(1, channels * width))
        _check_shape(path, "", (frames, channels))
        data = recording.readframes(frames)
        samples = _decode_pcm(data[: len(data) // (channels * width) * channels * width], width)
        rate = recording.getframerate()
    columns_of = samples.reshape(-1, channels).T / _WAV_FULL_SCALE[width]
    if channels == 1:
        return {columns.name_in_file("voltage_v"): columns_of[0], RATE: rate}
    return {**{str(number): column for number, column in enumerate(columns_of, 1)}, RATE: rate}


def _decode_pcm(data: bytes, width: int) -> NDArray[Any]:
    if width == 1:
        return np.frombuffer(data, np.uint8).astype(np.int16) - 128
    if width == 3:
        padded = np.zeros((len(data) // 3, 4), np.uint8)
        padded[:, 1:] = np.frombuffer(data, np.uint8).reshape(-1, 3)
        return padded.view("<i4").ravel() >> 8
    return np.frombuffer(data, f"<i{width}")


def _load_tdms(path: Path, columns: ColumnMap) -> Mapping[str, Any]:
    """Load channels by name. A single channel is the voltage, and the recording's increment gives the times."""
    nptdms = extras.load("nptdms", str(path), alternative=AS_CSV)

    def load(name: str) -> Any:
        channel, size = by_name[name], path.stat().st_size
        width = getattr(channel.dtype, "itemsize", 1)
        _check_shape(path, name, (len(channel),), width)
        if len(channel) > size:  # a value takes a byte at least
            raise ValueError(f"it states {len(channel)} values in a file of {size} bytes")
        return channel[:]

    remedy = "export it again, or save it as CSV"
    with _damage_reported(path, "a TDMS file", remedy), contextlib.ExitStack() as resources:
        with path.open("rb") as file:
            if file.read(4) != b"TDSm":  # the tag of every segment
                raise TraceError(Issue(str(path), f"is not a TDMS file; {remedy}."))
            check_tdms_segments(file)
        recording = resources.enter_context(nptdms.TdmsFile.open(path))
        channels = [channel for group in recording.groups() for channel in group.channels()]
        by_name = {channel.name: channel for channel in channels}
        if len(channels) == 1 and "voltage_v" not in columns.names:
            by_name = {"voltage_v": channels[0]}
        arrays = _skip_others(by_name, load, columns)
        voltage = by_name.get(columns.name_in_file("voltage_v"))
        increment = voltage.properties.get("wf_increment") if voltage is not None else None
        if increment is not None:
            with np.errstate(divide="ignore"):
                arrays[RATE] = float(f"{1 / np.float64(increment):.9g}")
        return arrays


LOADERS: Mapping[str, Callable[[Path, ColumnMap], Mapping[str, Any]]] = {
    "npy": _load_npy, "npz": _load_npz, "mat": _load_mat, "parquet": _load_parquet, "wav": _load_wav,
    "tdms": _load_tdms,
}  # fmt: skip
"""Kind of file -> function that loads arrays by name; those that no column names are None, so that messages suggest
them. Raises TraceError."""
