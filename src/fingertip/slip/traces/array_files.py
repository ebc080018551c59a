"""Trace files that hold arrays: NumPy, MATLAB, Parquet, WAV, TDMS and bags of ROS.

A file lists its arrays by name. Each is measured by its header before it is read, and only those
are read that are asked for.
"""

from __future__ import annotations

import io
import itertools
import math
import re
import wave
import zipfile
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fingertip.foundation import extras
from fingertip.foundation.errors import FingertipError, Issue, TraceError, shorten
from fingertip.foundation.input_files import RECORDING_LIMIT
from fingertip.foundation.workers import call_within_limits
from fingertip.slip.traces.trace import COLUMNS, max_table_bytes, shape_message

LIMIT_S = 60.0
"""Time limit for files whose lists, chunks and scales may keep a library busy for hours [s]."""
_MAX_HEADER_BYTES = 2**16
"""Maximum length of the header of a NumPy array. The library reads 10 000 characters."""
RATE = "sample_rate_hz"
"""Name of a number in a file that replaces its times."""
_MOST_ELEMENTS = 64
"""Largest length of a list of a message whose elements can be chosen."""
_MAX_TEXT_BYTES = 1000
"""Maximum size of an array of text that is loaded, as a rate may be [bytes]."""
_MAX_REASON = 200
"""Maximum length of a library's reason, which may repeat bytes of the file [characters]."""
Claim = tuple[tuple[int, ...], np.dtype[Any]]
"""Shape and type of an array, as its file states them."""
AS_CSV = "save the recording as CSV"


def load_arrays(kind: str, path: Path, names: Collection[str]) -> dict[str, Any]:
    """Load the arrays of these names, or below them; others that the file lists are None.

    Raises TraceError, MissingLibraryError or OSError.
    """
    noun, remedy, read, library = KINDS[kind]
    if library:
        extras.require(str(path), library, alternative=AS_CSV)

    try:
        if library in ("", "pyarrow"):
            return read(path, names)

        return call_within_limits(LIMIT_S, _memory_bytes(), read, path, names)
    except (FingertipError, FileNotFoundError, PermissionError):
        raise
    except Exception as error:  # a library may raise any for a damaged file
        reason = shorten(" ".join(str(error).split()) or type(error).__name__, _MAX_REASON)
        raise TraceError(
            Issue(str(path), f"is not {noun} that can be read ({reason}); {remedy}.")
        ) from None


def _memory_bytes() -> int:
    return 2**30 + 4 * max_table_bytes()  # a library itself takes some


def _load_numbers(
    path: Path, names: Iterable[str], claim: Callable[[str], Claim], load: Callable[[str], Any]
) -> dict[str, Any]:
    """Load arrays once all the sizes that they claim are within bounds.

    One that holds no numbers, or has more than two dimensions, is not loaded: an empty one of its
    type takes its place, which is refused by its name. A rate may be a short text.
    """
    claims = {name: claim(name) for name in names}
    loaded = list[str]()
    total = 0

    for name, (shape, dtype) in claims.items():
        if len(shape) <= 2:
            _check_shape(
                path,
                name=name,
                shape=shape,
                item_bytes=dtype.itemsize,
                other_bytes=total,
            )
            size = math.prod(shape) * dtype.itemsize
            if dtype.kind in "bifumM" or (dtype.kind in "cSU" and size <= _MAX_TEXT_BYTES):
                loaded.append(name)
                total += size

    empty = {name: np.zeros((0,) * len(shape), dtype) for name, (shape, dtype) in claims.items()}
    return empty | {name: load(name) for name in loaded}


def _check_shape(
    path: Path,
    name: str,
    shape: tuple[int, ...],
    item_bytes: int = 8,
    other_bytes: int = 0,
) -> None:
    """Refuse a shape that is too large, beside other arrays [bytes]. Raises TraceError."""
    message = shape_message(shape, item_bytes, other_bytes)
    if message:
        raise TraceError(Issue(f"{path}, {name}" if name else str(path), message))


def _name_columns(rows: NDArray[Any], names: tuple[str, ...]) -> dict[str, Any]:
    """Name the columns of an array by number, and as a trace's if there are no more."""
    columns = {str(number): column for number, column in enumerate(rows.T, 1)}
    if len(columns) > len(names):
        return columns

    return dict(zip(names[-len(columns) :], rows.T, strict=False)) | columns


def _read_npy(path: Path, names: Collection[str]) -> dict[str, Any]:
    with path.open("rb") as file:
        shape, dtype = _read_npy_header(file)

    _check_shape(path, "", shape, dtype.itemsize)
    array = np.load(path, allow_pickle=False)
    if array.dtype.names:
        return {name: array[name] for name in array.dtype.names}
    if array.ndim == 1 or (array.ndim == 2 and 1 in array.shape):
        array = array.reshape(-1, 1)

    if array.ndim != 2:
        message = f"has shape {array.shape}; give (samples,) with --rate-hz, or (samples, columns)."
        raise TraceError(Issue(str(path), message))

    return _name_columns(array, COLUMNS[:2])


def _read_npz(path: Path, names: Collection[str]) -> dict[str, Any]:
    def claim(name: str) -> Claim:
        with archive.open(members[name]) as member:
            return _read_npy_header(member)

    def load(name: str) -> Any:
        with archive.open(members[name]) as member:
            return np.lib.format.read_array(member, allow_pickle=False)

    with path.open("rb") as file:
        archive = zipfile.ZipFile(file)
        members = {name.removesuffix(".npy"): name for name in archive.namelist()}
        return dict.fromkeys(members) | _load_numbers(
            path, members.keys() & set(names), claim, load
        )


def _read_npy_header(recording: Any) -> Claim:
    # The library would read whatever length the header states.
    file = io.BytesIO(recording.read(_MAX_HEADER_BYTES))
    if np.lib.format.read_magic(file) == (1, 0):
        shape, _, dtype = np.lib.format.read_array_header_1_0(file)
    else:
        shape, _, dtype = np.lib.format.read_array_header_2_0(file)

    if dtype.hasobject:
        raise ValueError("it holds objects, which only pickle reads")

    return shape, dtype


def _read_mat(path: Path, names: Collection[str]) -> dict[str, Any]:
    """Read variables by name; numbers in structures as STRUCT/FIELD, in cells as CELL(1)."""
    scipy_io = extras.load("scipy.io", str(path), alternative=AS_CSV)
    arrays = dict[str, Any]()

    def add(name: str, value: Any) -> None:
        if isinstance(value, dict):
            for field, element in value.items():
                add(f"{name}/{field}", element)
        elif isinstance(value, (list, np.ndarray)) and np.asarray(value).dtype.kind == "O":
            for number, element in enumerate(np.ravel(value), 1):
                add(f"{name}({number})", element)
        else:
            arrays[name] = np.asarray(value)
            _check_shape(path, name, arrays[name].shape, arrays[name].itemsize)

    in_file = [name for name, _, _ in scipy_io.whosmat(path)]
    variables = {re.split(r"[/(]", name)[0] for name in names}.intersection(in_file)
    values = scipy_io.loadmat(path, variable_names=[*variables], simplify_cells=True)
    for name in sorted(variables, key=in_file.index):
        add(name, values[name])

    return dict.fromkeys(in_file) | arrays


def _read_parquet(path: Path, names: Collection[str]) -> dict[str, Any]:
    parquet, types = (
        extras.load(f"pyarrow.{name}", str(path), alternative=AS_CSV)
        for name in ("parquet", "types")
    )
    is_number = (
        types.is_integer,
        types.is_floating,
        types.is_boolean,
        types.is_timestamp,
        types.is_duration,
    )
    with parquet.ParquetFile(path) as file:
        rows = file.metadata.num_rows
        fields = file.schema_arrow
        _check_shape(path, "", (rows,))
        groups = (file.metadata.row_group(number) for number in range(file.metadata.num_row_groups))
        unpacked = sum(group.total_byte_size for group in groups)
        if unpacked > RECORDING_LIMIT.value:
            raise ValueError(f"it unpacks to {unpacked / 2**20:.0f} MB")

        def claim(name: str) -> Claim:
            # The library takes `voltage_v.raw` too where it is asked for `voltage_v`.
            kinds = [field.type for field in fields if f"{field.name}.".startswith(f"{name}.")]
            are_numbers = all(any(test(kind) for test in is_number) for kind in kinds)
            return (rows,), np.dtype("f8" if are_numbers else "O")

        def load(name: str) -> Any:
            values: Any = None
            count = 0
            for batch in file.iter_batches(columns=[name], use_threads=False):
                column = batch.column(name)
                # Its method to_numpy imports pandas.
                is_plain = types.is_floating(column.type) and not column.null_count
                part = np.from_dlpack(column) if is_plain else column.to_numpy(zero_copy_only=False)
                if values is None:
                    values = np.empty(rows, part.dtype)

                values = values.astype(np.result_type(values, part), copy=False)
                values[count : count + len(part)] = part
                count += len(part)

            return values

        in_file = dict.fromkeys(fields.names)
        return in_file | _load_numbers(path, in_file.keys() & set(names), claim, load)


def _read_wav(path: Path, names: Collection[str]) -> dict[str, Any]:
    with path.open("rb") as file, wave.open(file) as recording:
        channels = recording.getnchannels()
        width = recording.getsampwidth()
        if not 1 <= width <= 4:
            raise ValueError(f"its samples have {8 * width} bits")

        frames = min(recording.getnframes(), path.stat().st_size // max(1, channels * width))
        _check_shape(path, "", (frames, channels))
        data = np.frombuffer(recording.readframes(frames), np.uint8)
        rate_hz = recording.getframerate()

    padded = np.zeros((len(data) // (channels * width) * channels, 4), np.uint8)
    sign_bit = 128 if width == 1 else 0  # samples of one byte are counted from 0
    padded[:, 4 - width :] = data[: len(padded) * width].reshape(-1, width) ^ sign_bit
    samples = padded.view("<i4").reshape(-1, channels) / 2.0**31
    return _name_columns(samples, ("voltage_v",)) | {RATE: rate_hz}


def _read_tdms(path: Path, names: Collection[str]) -> dict[str, Any]:
    """Read channels by name.

    A single one is the voltage, and the increment of one that is read gives the times.
    """
    nptdms = extras.load("nptdms", str(path), alternative=AS_CSV)

    def claim(name: str) -> Claim:
        channel = by_name[name]
        size = path.stat().st_size
        if len(channel) > size:  # a value takes a byte at least
            raise ValueError(f"it states {len(channel)} values in a file of {size} bytes")

        return (len(channel),), np.dtype(channel.dtype)

    # By its path, the library would also read an index file beside it.
    with path.open("rb") as file, nptdms.TdmsFile.open(file) as recording:
        channels = [*itertools.chain.from_iterable(map(_list_channels, recording.groups()))]
        by_name = {f"{channel.group_name}/{channel.name}": channel for channel in channels}
        counts = Counter(channel.name for channel in channels)
        shortest = {
            channel.name if counts[channel.name] == 1 else path_in_file: channel
            for path_in_file, channel in by_name.items()
        }
        by_name |= shortest
        if len(shortest) == 1:
            by_name["voltage_v"] = channels[0]

        arrays = _load_numbers(
            path, by_name.keys() & set(names), claim, lambda name: by_name[name][:]
        )
        steps = [by_name[name].properties.get("wf_increment") for name in arrays]
        step = next((step for step in steps if step is not None), None)
        with np.errstate(divide="ignore"):
            rate = {} if step is None else {RATE: float(f"{1 / np.float64(step):.9g}")}

        return dict.fromkeys(shortest) | arrays | rate


def _list_channels(group: Any) -> list[Any]:
    return group.channels()  # type: ignore[no-any-return]


def _read_bag(path: Path, names: Collection[str]) -> dict[str, Any]:
    """Read the numbers of messages as /topic.field, and elements of their lists as /topic.field/2.

    The time of each message in the bag is /topic.bag_time [s].
    """
    highlevel, typesys = (
        extras.load(f"rosbags.{name}", str(path)) for name in ("highlevel", "typesys")
    )
    values = dict[str, list[float]]()
    begin_ns = 0

    def add(name: str, value: Any) -> None:
        fields = getattr(value, "__dataclass_fields__", None)
        if fields:
            for field in fields:
                add(f"{name}.{field}", getattr(value, field))
        elif np.ndim(value) == 1 and len(value) <= _MOST_ELEMENTS:
            for number, element in enumerate(value, 1):
                add(f"{name}/{number}", element)
        elif np.ndim(value) == 0 and np.asarray(value).dtype.kind in "biuf":
            values.setdefault(name, []).append(float(value))

    typestore = typesys.get_typestore(typesys.Stores.LATEST)
    with highlevel.AnyReader([path], default_typestore=typestore) as bag:
        connections = [
            connection
            for connection in bag.connections
            if any(name.startswith(f"{connection.topic}.") for name in names)
        ]
        for connection, time_ns, data in bag.messages(connections):
            begin_ns = begin_ns or time_ns
            add(f"{connection.topic}.bag_time", 1e-9 * (time_ns - begin_ns))
            add(connection.topic, bag.deserialize(data, connection.msgtype))

    return {name: np.array(numbers) for name, numbers in values.items()}


class _Kind(NamedTuple):
    """Kind of files, with the function that reads their arrays by name."""

    noun: str
    remedy: str
    """Advice where a file is damaged."""
    read: Callable[[Path, Collection[str]], dict[str, Any]]
    library: str = ""
    """Optional package that reads it; but for pyarrow in a process of its own."""


KINDS: Mapping[str, _Kind] = {
    "npy": _Kind("a NumPy file", "save numbers with numpy.savez", _read_npy),
    "npz": _Kind("a NumPy archive", "save numbers with numpy.savez, without a password", _read_npz),
    "mat": _Kind("a MATLAB file", "save it with -v7, or as CSV", _read_mat, "scipy"),
    "parquet": _Kind("a Parquet file", "save it again, or as CSV", _read_parquet, "pyarrow"),
    "wav": _Kind("a WAV file", "save it as PCM of 16 or 24 bits, or as CSV", _read_wav),
    "tdms": _Kind("a TDMS file", "export it again, or save it as CSV", _read_tdms, "nptdms"),
    "bag": _Kind(
        "a bag of ROS",
        "convert one topic to CSV with `ros2 topic echo --csv /topic`",
        _read_bag,
        "rosbags",
    ),
}
"""Kinds of files of arrays."""
