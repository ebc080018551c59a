"""Trace files that hold arrays: NumPy, MATLAB, Parquet, WAV, TDMS and bags of ROS.

Every array is measured by its header before it is read, and only those are read that a trace takes.
"""

from __future__ import annotations

import contextlib
import io
import math
import wave
import zipfile
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fingertip.foundation import extras
from fingertip.foundation.errors import FingertipError, Issue, TraceError, shorten
from fingertip.foundation.input_files import RECORDING_LIMIT, check_archive, check_member
from fingertip.foundation.workers import call_within_limits
from fingertip.slip.traces.trace import BOARD_COLUMNS, ColumnMap, max_table_bytes, shape_message, total_message

LIMIT_S = 60.0
"""Time for a file that may state lists, chunks and scales that take a library hours or all memory [s]."""
_MAX_HEADER_BYTES = 2**16
"""Maximum length of the header of a NumPy array. The library reads 10 000 characters."""
RATE = "sample_rate_hz"
"""Name of a number in a file that replaces its times."""
_ROS_MODULES, _MOST_ELEMENTS = ("highlevel", "typesys"), 64
"""Modules that read bags, and largest length of a list of a message whose elements can be chosen."""
_MAX_TEXT_BYTES = 1000
"""Maximum size of an array of text that is loaded, as a rate may be [bytes]."""
_MAX_REASON = 200
"""Maximum length of the reason that a library gives, which may repeat bytes of the file [characters]."""
Claim = tuple[tuple[int, ...], np.dtype[Any]]
"""Shape and type of an array, as its file states them."""
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
    """Return the names of the arrays that a trace takes; `NAME/2` is a column of the array NAME."""
    names = {*map(columns.name_in_file, columns.looked_for)}
    tables = {name.rpartition("/")[0] for name in names if name.rpartition("/")[2].isdecimal()}
    return {*names, *tables, *(f"sampled_{column}" for column in BOARD_COLUMNS), RATE}


def _load_numbers(path: Path, claims: Mapping[str, Claim], load: Callable[[str], Any]) -> dict[str, Any]:
    """Load arrays once all of what they claim is within bounds. An array that holds no numbers is not loaded.

    An empty one of its type takes its place, which is refused by its name; a rate may be a short text.
    """
    sizes: dict[str, int] = {}
    for name, (shape, dtype) in claims.items():
        _check_shape(path, name, shape, dtype.itemsize)
        size = math.prod(shape) * dtype.itemsize
        if dtype.kind in "bifumM" or (dtype.kind in "cSU" and size <= _MAX_TEXT_BYTES):
            sizes[name] = size
    if message := total_message(sum(sizes.values())):
        raise TraceError(Issue(str(path), message))
    return {name: load(name) if name in sizes else np.zeros(0, dtype) for name, (_, dtype) in claims.items()}


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
    if array.ndim == 2 and array.shape[1] == 2 and not (voltage.isdecimal() or time.isdecimal()):
        # The columns of an array have no names: a name for the time (`--column time_s=none`) means to ignore it.
        if columns.rate_hz is not None and "time_s" in columns.names:
            return {voltage: array[:, 1]}
        return {time: array[:, 0], voltage: array[:, 1]}
    if array.ndim == 2:
        return {str(number): column for number, column in enumerate(array.T, 1)}
    message = f"has shape {array.shape}; give (samples,) with --rate-hz, or (samples, columns)."
    raise TraceError(Issue(str(path), message))


def _load_npz(path: Path, columns: ColumnMap) -> Mapping[str, Any]:
    def read_claim(name: str) -> Claim:
        check_member(archive.getinfo(members[name]))
        with archive.open(members[name]) as member:
            return _read_npy_header(member)

    def load(name: str) -> Any:
        with archive.open(members[name]) as member:
            return np.lib.format.read_array(member, allow_pickle=False)

    with (
        _damage_reported(path, "a NumPy archive", "save numbers with numpy.savez, without a password"),
        path.open("rb") as file,
    ):
        check_archive(file)
        archive = zipfile.ZipFile(file)
        members = {name.removesuffix(".npy"): name for name in archive.namelist()}
        claims = {name: read_claim(name) for name in members if name in _wanted(columns)}
        return dict.fromkeys(members) | _load_numbers(path, claims, load)


def _read_npy_header(recording: Any) -> Claim:
    file = io.BytesIO(recording.read(_MAX_HEADER_BYTES))  # the library would read whatever length the header states
    version = np.lib.format.read_magic(file)
    read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, _, dtype = read(file)
    if dtype.hasobject:
        raise ValueError("it holds objects, which only pickle reads")
    return shape, dtype


def _load_mat(path: Path, columns: ColumnMap) -> Mapping[str, Any]:
    extras.require(str(path), "scipy", alternative=AS_CSV)
    with _damage_reported(path, "a MATLAB file", "save it with -v7, or as CSV"):
        return call_within_limits(LIMIT_S, _memory_bytes(), _read_mat, path, columns)


def _memory_bytes() -> int:
    return 2**30 + 4 * max_table_bytes()  # a library itself takes some


def _read_mat(path: Path, columns: ColumnMap) -> Mapping[str, Any]:
    """Read variables by name, and the numbers in structures and cells as STRUCT/FIELD, of several STRUCT(1)/FIELD."""
    scipy_io = extras.load("scipy.io", str(path), alternative=AS_CSV)
    found = dict[str, Any]()

    def add(name: str, value: Any) -> None:
        if isinstance(value, dict):
            for field, element in value.items():
                add(f"{name}/{field}", element)
        elif isinstance(value, (list, np.ndarray)) and np.asarray(value).dtype.kind == "O":
            for number, element in enumerate(np.ravel(value), 1):
                add(f"{name}({number})", element)
        else:
            found[name] = np.asarray(value)
            _check_shape(path, name, found[name].shape, found[name].itemsize)

    names = [name for name, _, _ in scipy_io.whosmat(path)]
    has_all = set(map(columns.name_in_file, columns.required)) <= set(names)
    wanted = _wanted(columns).intersection(names) if has_all else names
    for name, value in scipy_io.loadmat(path, variable_names=list(wanted), simplify_cells=True).items():
        if name in wanted:
            add(name, value)
    return dict.fromkeys(names if has_all else ()) | found


def _load_parquet(path: Path, columns: ColumnMap) -> Mapping[str, Any]:
    parquet = extras.load("pyarrow.parquet", str(path), alternative=AS_CSV)
    types = extras.load("pyarrow.types", str(path), alternative=AS_CSV)
    with _damage_reported(path, "a Parquet file", "save it again, or as CSV"), parquet.ParquetFile(path) as file:
        rows = file.metadata.num_rows
        _check_shape(path, "", (rows,))
        groups = (file.metadata.row_group(number) for number in range(file.metadata.num_row_groups))
        if (unpacked := sum(group.total_byte_size for group in groups)) > RECORDING_LIMIT.value:
            raise ValueError(f"it unpacks to {unpacked / 2**20:.0f} MB")

        def load(name: str) -> Any:
            parts, count = list[Any](), 0
            for batch in file.iter_batches(columns=[name]):
                count += len(batch)
                _check_shape(path, "", (count,))
                parts.append(batch.column(name).to_numpy(zero_copy_only=False))
            return np.concatenate(parts) if parts else None

        is_number = (types.is_integer, types.is_floating, types.is_boolean, types.is_timestamp, types.is_duration)
        claims: dict[str, Claim] = {}
        for field in file.schema_arrow:
            # The library takes `voltage_v.raw` too where it is asked for `voltage_v`.
            for name in (name for name in _wanted(columns) if f"{field.name}.".startswith(f"{name}.")):
                is_loaded = name not in claims and any(test(field.type) for test in is_number)
                claims[name] = (rows,), np.dtype("f8" if is_loaded else "O")
        return dict.fromkeys(file.schema_arrow.names) | _load_numbers(path, claims, load)


def _load_wav(path: Path, columns: ColumnMap) -> Mapping[str, Any]:
    with (
        _damage_reported(path, "a WAV file", "save it as PCM of 16 or 24 bits, or as CSV"),
        path.open("rb") as file,
        wave.open(file) as recording,
    ):
        channels, width = recording.getnchannels(), recording.getsampwidth()
        if width not in _WAV_FULL_SCALE:
            raise ValueError(f"its samples have {8 * width} bits")
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
    extras.require(str(path), "nptdms", alternative=AS_CSV)
    with _damage_reported(path, "a TDMS file", "export it again, or save it as CSV"):
        return call_within_limits(LIMIT_S, _memory_bytes(), _read_tdms, path, columns)


def _read_tdms(path: Path, columns: ColumnMap) -> Mapping[str, Any]:
    nptdms = extras.load("nptdms", str(path), alternative=AS_CSV)

    def read_claim(channel: Any) -> Claim:
        if len(channel) > (size := path.stat().st_size):  # a value takes a byte at least
            raise ValueError(f"it states {len(channel)} values in a file of {size} bytes")
        return (len(channel),), np.dtype(channel.dtype)

    # By its path, the library would also read an index file beside it.
    with path.open("rb") as file, nptdms.TdmsFile.open(file) as recording:
        channels = [channel for group in recording.groups() for channel in group.channels()]
        by_path = {f"{channel.group_name}/{channel.name}": channel for channel in channels}
        counts = Counter(channel.name for channel in channels)
        listed = {each.name if counts[each.name] == 1 else key: each for key, each in by_path.items()}
        if len(channels) == 1 and "voltage_v" not in columns.names:
            listed = {"voltage_v": channels[0]}
        by_name = {**by_path, **listed}
        claims = {name: read_claim(by_name[name]) for name in by_name if name in _wanted(columns)}
        arrays = dict.fromkeys(listed) | _load_numbers(path, claims, lambda name: by_name[name][:])
        voltage = by_name.get(columns.name_in_file("voltage_v"))
        increment = voltage.properties.get("wf_increment") if voltage is not None else None
        if increment is not None:
            with np.errstate(divide="ignore"):
                arrays[RATE] = float(f"{1 / np.float64(increment):.9g}")
        return arrays


def _load_bag(path: Path, columns: ColumnMap) -> Mapping[str, Any]:
    extras.require(str(path), "rosbags", alternative="convert one topic to CSV with `ros2 topic echo --csv /topic`")
    with _damage_reported(path, "a bag of ROS", "convert one topic to CSV"):
        return call_within_limits(LIMIT_S, _memory_bytes(), _read_bag, path, columns)


def _read_bag(path: Path, columns: ColumnMap) -> Mapping[str, Any]:
    """Read the numbers of messages as /topic.field, and elements of their lists as /topic.field/2.

    The time of each message in the bag is /topic.bag_time [s].
    """
    highlevel, typesys = (extras.load(f"rosbags.{name}", str(path), alternative=AS_CSV) for name in _ROS_MODULES)
    found, begin_ns = dict[str, list[float]](), 0

    def add(name: str, value: Any) -> None:
        if fields := getattr(value, "__dataclass_fields__", None):
            for field in fields:
                add(f"{name}.{field}", getattr(value, field))
        elif np.ndim(value) == 1 and len(value) <= _MOST_ELEMENTS:
            for number, element in enumerate(value, 1):
                add(f"{name}/{number}", element)
        elif np.ndim(value) == 0 and np.asarray(value).dtype.kind in "biuf":
            found.setdefault(name, []).append(float(value))

    wanted, store = _wanted(columns), typesys.get_typestore(typesys.Stores.LATEST)
    with highlevel.AnyReader([path], default_typestore=store) as bag:
        named = [each for each in bag.connections if any(name.startswith(f"{each.topic}.") for name in wanted)]
        for connection, time_ns, data in bag.messages(named):
            begin_ns = begin_ns or time_ns
            add(f"{connection.topic}.bag_time", 1e-9 * (time_ns - begin_ns))
            add(connection.topic, bag.deserialize(data, connection.msgtype))
    return {name: np.array(values) for name, values in found.items()}


LOADERS: Mapping[str, Callable[[Path, ColumnMap], Mapping[str, Any]]] = {
    "npy": _load_npy, "npz": _load_npz, "mat": _load_mat, "parquet": _load_parquet, "wav": _load_wav,
    "tdms": _load_tdms, "bag": _load_bag,
}  # fmt: skip
"""Kind of file -> function that loads arrays by name; those that no column names are None, so that messages suggest
them. Raises TraceError."""
