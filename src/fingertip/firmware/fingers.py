"""Fingers that one controller reads: their names and inputs, and what the controller can carry."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from fingertip.catalogues.electronics import NAMES, ControllerBoard, load_controllers, plain_name
from fingertip.design import Design
from fingertip.design.finger_set import FingerSet
from fingertip.firmware.measured_costs import read_costs
from fingertip.foundation.errors import FingertipError, Issue, join_words, quote_value, raise_issues
from fingertip.slip.detectors.fast_settings import TICK_S

DEFAULT_CONTROLLER = "black_pill_f411"
"""Controller of several fingers, unless another one is named: a small board that carries five."""
DIVIDER_CONTROLLER = "teensy40"
"""The same for fingers that are read by dividers."""
CONVERSIONS = 4
TASK_CONVERSIONS = 8
"""Conversions per sample of a divider: in an interrupt, and in an ESP32-S3's task."""
CYCLES_PER_INSTRUCTION = 1.5
"""Assumed clock cycles of an instruction: most take one, loads and jumps two; with waits."""
BUFFER_SAMPLES = 1024
"""Samples that may wait in the ring buffer of `slip_buffer.h`."""
CODE_BYTES = 2
OTHER_RAM_KB = 6
"""Memory for the grip law, the stack and the controller's own software, estimated."""
INTERRUPT_SHARE = 0.5
"""Share of a sample that `analogRead` may take."""
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,15}")


@dataclass(frozen=True)
class Fingers:
    """Fingers of a library, in the order of its detectors."""

    names: tuple[str, ...] = ("finger",)
    inputs: tuple[tuple[str, str], ...] = (("A0", "A1"),)
    """Analog inputs of T and S of each finger; of a divider, its one."""
    controller: ControllerBoard | None = None
    designs: tuple[Design, ...] = ()
    """Design of each finger, with its pad and curve; empty if all are the library's."""

    @property
    def count(self) -> int:
        return len(self.names)

    @property
    def is_hand(self) -> bool:
        """True if the library holds the scan and the example of a hand."""
        return self.controller is not None


ONE_FINGER = Fingers()


@dataclass(frozen=True)
class Load:
    """Clock cycles between two samples, and those of the detectors of some fingers."""

    available: int
    at_rest: int
    """Mean at a constant force."""
    mean: int
    """Mean while slip lasts at all fingers."""
    longest: int
    """Most if all fingers slip: with the trees of as many fingers as one sample evaluates."""


def find_load(board: ControllerBoard, sample_rate_hz: float, fingers: int = 1) -> Load:
    """Find the load of a controller at a sampling rate.

    Each processor takes as many instructions as the measured one of its kind. This overestimates a
    Cortex-M3, which has instructions that a Cortex-M0+ lacks.
    """
    target = read_costs()["targets"]["Cortex-M4F" if board.has_floats else "Cortex-M0+"]
    counts = target["instructions"]
    short = target["short_instructions"]
    longest = target["max_instructions"]
    tick_samples, measured = (
        max(1, round(TICK_S * rate)) for rate in (sample_rate_hz, read_costs()["sample_rate_hz"])
    )
    with_trees = math.ceil(fingers / tick_samples)
    of_five = math.ceil(5 / measured)
    # Where slip begins at all fingers at once, all check their samples in the longest one of five.
    without = max(short, (target["five_fingers"]["max"] - of_five * longest) / (5 - of_five))
    worst = with_trees * longest + (fingers - with_trees) * without

    def cycles(count: float) -> int:
        return math.ceil(CYCLES_PER_INSTRUCTION * count / 100) * 100

    available = math.floor(1e4 * board.clock_mhz / sample_rate_hz) * 100
    slip = max(counts["slip"], target["five_fingers"]["slip"] / 5)
    # The trees are evaluated as often at any rate.
    slip = short + (slip - short) * measured / tick_samples
    return Load(available, cycles(fingers * counts["quiet"]), cycles(fingers * slip), cycles(worst))


def list_controllers(design: Design) -> list[ControllerBoard]:
    """List the controllers that read what the design has: a board, or a divider."""
    if not design.board.has_filter:
        return [
            board
            for board in load_controllers()
            if board.timer in ("yes", "in the sketch") and not board.has_scan
        ]

    return [board for board in load_controllers() if board.timer in ("yes", "no")]


def list_limits(
    board: ControllerBoard, sample_rate_hz: float, has_divider: bool = False
) -> dict[str, int]:
    """Return how many fingers a controller carries, by each of its limits."""
    load = find_load(board, sample_rate_hz)
    has_task = board.timer == "in the sketch"
    inputs = 2
    conversions = 2
    if has_divider:
        inputs = 1
        conversions = TASK_CONVERSIONS if has_task else CONVERSIONS

    share = 1.0 if board.has_scan or has_task else INTERRUPT_SHARE
    finger_bytes = read_costs()["state_bytes"] + 2 * CODE_BYTES * BUFFER_SAMPLES
    by_ram = 1024 * (board.ram_kb - OTHER_RAM_KB) / finger_bytes

    return {
        "analog inputs": len(board.inputs) // inputs,
        "conversions": math.floor(share * 1e6 / (conversions * board.convert_us * sample_rate_hz)),
        "bytes of memory": math.floor(by_ram),
        "cycles while all slip": math.floor(load.available / load.mean),
    }


def find_controller(design: Design, name: str | None = None) -> ControllerBoard | None:
    """Find a controller by its usual name or description; without a name the default."""
    name = name or (DEFAULT_CONTROLLER if design.board.has_filter else DIVIDER_CONTROLLER)
    return _parse_generic(name) or _find_by_name(name, list_controllers(design))


def _find_by_name(name: str, boards: Sequence[ControllerBoard]) -> ControllerBoard | None:
    plain = plain_name(name)
    for board in boards:
        if plain in (plain_name(board.key), plain_name(board.name), *board.names):
            return board

    return None


GENERIC = "generic"
_EXAMPLE = f"{GENERIC}:240MHz,12bit,A0,A1"
"""Description of a controller that is not in the table."""


def _parse_generic(text: str) -> ControllerBoard | None:
    """Parse the description of a controller, such as `_EXAMPLE`; None for any other text.

    It computes floats itself with the word `floats`. The range of its converter is 3.3 V, if no
    other one such as 5V is stated. Its memory and the time of a conversion are those of the weakest
    boards of the table.
    """
    start, _, rest = text.replace(" ", "").partition(":")
    words = rest.split(",")
    pins = [word for word in words if _PIN.fullmatch(word)]
    sizes: dict[str, float] = {}
    unknown = set(words) - {*pins, "floats"}

    for word in words:
        match = _SIZE.fullmatch(word)
        if match:
            sizes[match[2].lower()] = float(match[1])
            unknown.discard(word)

    if start != GENERIC or unknown or not pins or "mhz" not in sizes:
        return None
    if not 8 <= sizes.get("bit", 0) <= 24:
        return None

    bits = round(sizes["bit"])
    return ControllerBoard(
        key=GENERIC,
        name="your controller",
        processor="processor of your own",
        clock_mhz=sizes["mhz"],
        has_floats="floats" in words,
        adc_bits=bits,
        adc_hardware_bits=bits,
        adc_from_v=0.0,
        adc_to_v=sizes.get("v", 3.3),
        timer="no",
        note="where `slip_timer.h` knows no timer of it, start one of your own",
        inputs=tuple(pins),
        ram_kb=32,
        convert_us=50.0,
        has_scan=False,
    )


_SIZE = re.compile(r"(?i)([1-9]\d*\.?\d*)(mhz|bit|v)s?")
_PIN = re.compile(r"[A-Z]{0,4}_?\d{1,2}")


def _explain_controller(design: Design, name: str, fingers: int) -> str:
    """Explain why a controller is refused, with one that carries the fingers."""
    board = _find_by_name(name, load_controllers())
    rate_hz = design.detector.sample_rate_hz

    if board is None:
        keys = join_words([controller.key for controller in list_controllers(design)], "or")
        return f"{quote_value(name)} is not known; give {keys}, or your own such as {_EXAMPLE}."

    if board.timer == "too slow":
        load = find_load(board, rate_hz)
        at_rest_ms, slip_ms = (
            cycles / (1e3 * board.clock_mhz) for cycles in (load.at_rest, load.mean)
        )
        reason = (
            f"{quote_value(name)} is too slow: a sample takes at least {at_rest_ms:.1f} ms at "
            f"{board.clock_mhz:g} MHz without floats, {slip_ms:.1f} ms in slip, and the next one "
            f"comes after {1e3 / rate_hz:g} ms; give"
        )
    elif board.timer == "in the sketch":
        reason = (
            f"{board.name} converts {board.converter}, and a board gives up to "
            f"{design.board.supply_v:g} V; give --set board.variant=divider, which it reads, or"
        )
    else:
        reason = f"{board.name} has no timer in the sketch of a divider; give"

    return f"{reason} --controller {_find_carrier(design, fingers)}."


def _find_carrier(design: Design, fingers: int) -> str:
    """Find a controller that carries the fingers, or that of most designs where none does."""
    rate_hz = design.detector.sample_rate_hz
    has_divider = not design.board.has_filter
    boards = [
        board.key
        for board in list_controllers(design)
        if count_fingers(board, rate_hz, has_divider) >= fingers
    ]
    if not boards:
        return "teensy40 with --set detector.sample_rate_hz=2000"

    return "pico_2" if "pico_2" in boards else boards[0]


def count_fingers(board: ControllerBoard, sample_rate_hz: float, has_divider: bool = False) -> int:
    return min(len(NAMES), *list_limits(board, sample_rate_hz, has_divider).values())


def plan_fingers(
    design: Design,
    fingers: str | None = None,
    controller: str | None = None,
    inputs: str | None = None,
) -> Fingers:
    """Give each finger a name and its inputs. Raises FingertipError, with all that is wrong.

    `fingers` are their number, or their names, separated by commas; None for as many as the
    design's board has channels. None as `controller` is the default one of several fingers, and any
    controller of one. `inputs` are its analog inputs, T and S of each finger in turn, or one for
    each divider, separated by commas, or None for the first.
    """
    issues: list[Issue] = []
    channels = design.board.channels
    names = _read_names(str(channels) if fingers is None else fingers, issues)
    if channels > 1:
        issues += _find_place_issues(names, channels)

    signals = ("T", "S") if design.board.has_filter else ("T",)
    board = None
    if controller is not None or inputs is not None or names != Fingers.names:
        board = find_controller(design, controller)
        if board is None:
            message = _explain_controller(design, controller or "", len(names))
            issues.append(Issue("--controller", message))

    raise_issues(FingertipError, issues)
    if board:
        issues += _find_limit_issues(design, board, len(names))

    pins = _read_inputs(
        inputs,
        board=board,
        names=names,
        letters=signals,
        issues=issues,
    )
    raise_issues(FingertipError, issues)
    pins_by_signal = (pins[i :: len(signals)] for i in range(len(signals)))
    return Fingers(names, tuple(zip(*pins_by_signal, strict=True)), board)


def _find_place_issues(names: Sequence[str], channels: int) -> Iterator[Issue]:
    """Yield an issue if fingers have no place on a board of some channels."""
    last = max(list_places(names), default=0)
    if channels < len(names):
        remedy = f"give --fingers {channels}, or --set board.channels={len(names)}"
        problem = f"{len(names)} are more than the {channels} of the design's board"
        yield Issue("--fingers", f"{problem}; {remedy}.")
    elif channels < last:
        problem = f"{NAMES[last - 1]} has place {last}, and the design's board {channels}"
        remedy = f"give --set board.channels={last}, or leave {NAMES[last - 1]} out"
        yield Issue("--fingers", f"{problem}; {remedy}.")


def list_places(names: Sequence[str]) -> list[int]:
    """List the places of fingers on one board, from 1: by usual names, or in turn."""
    if all(name in NAMES for name in names):
        return [NAMES.index(name) + 1 for name in names]

    return list(range(1, len(names) + 1))


def plan_set(
    fingers: FingerSet, controller: str | None = None, inputs: str | None = None
) -> tuple[Design, Fingers]:
    """Plan the fingers of a set; return the design of their board too. Raises FingertipError."""
    designs = fingers.designs
    first = next(iter(designs.values()))
    issues = [
        Issue(
            table,
            f"is not the same in all fingers of the set; give {table} the same values for one "
            "controller.",
        )
        for table in ("board", "detector")
        if any(getattr(design, table) != getattr(first, table) for design in designs.values())
    ]
    raise_issues(FingertipError, issues)
    design = fingers.board_design or first.model_copy(update={"name": fingers.name})
    planned = plan_fingers(design, ",".join(designs), controller, inputs)

    return design, replace(planned, designs=tuple(designs.values()))


def _read_names(fingers: str, issues: list[Issue]) -> tuple[str, ...]:
    words = [word.strip() for word in fingers.split(",")]
    most = len(NAMES)
    problems = list[str]()

    if len(words) == 1 and re.fullmatch(r"[+-]?\d{1,9}", words[0]):
        if 1 <= int(words[0]) <= most:
            return NAMES[: int(words[0])] if int(words[0]) > 1 else Fingers.names

        problems.append(
            f"{int(words[0])} is not between 1 and {most}; give at least 1 and at most {most}."
        )
    elif len(words) > most:
        problems.append(
            f"{len(words)} names are more than {most}; give --fingers {','.join(NAMES)}."
        )
    else:
        rule = f"a letter, then up to 15 letters, digits, - or _; give --fingers {NAMES[0]}."
        problems += (
            f"{quote_value(word)} is no name: {rule}" for word in words if not _NAME.fullmatch(word)
        )
        if len(set(words)) < len(words):
            problems.append(
                f"two fingers have one name; give --fingers {','.join(NAMES[: len(words)])}."
            )

    issues += (Issue("--fingers", problem) for problem in problems)
    return tuple(words)


def _find_limit_issues(design: Design, board: ControllerBoard, fingers: int) -> Iterator[Issue]:
    rate_hz = design.detector.sample_rate_hz
    has_divider = not design.board.has_filter
    limits = list_limits(board, rate_hz, has_divider)
    exceeded = [f"{limit} for {most}" for limit, most in limits.items() if fingers > most]

    if exceeded:
        carried = count_fingers(board, rate_hz, has_divider)
        fewer = f"--fingers {carried} or " if carried else ""
        fit = _find_carrier(design, fingers)
        text = f"{board.name} has {join_words(exceeded)} at {rate_hz:g} Hz, not for {fingers}"
        yield Issue("--fingers", f"{text}; give {fewer}--controller {fit}.")


def _read_inputs(
    inputs: str | None,
    board: ControllerBoard | None,
    names: Sequence[str],
    letters: Sequence[str],
    issues: list[Issue],
) -> list[str]:
    available = board.inputs if board else ()
    signals = [f"{signal} of {name}" for name in names for signal in letters]
    if inputs is None:
        return list(available[: len(signals)]) if board else ["A0", "A1"][: len(letters)]

    pins = [word.strip() for word in inputs.split(",")]
    number = "two" if len(letters) == 2 else "one"
    problems = []
    if len(pins) != len(signals):
        problems.append(f"{len(pins)} inputs are not {number} a finger")

    for pin in sorted(set(pins)):
        owners = [signal for signal, own in zip(signals, pins, strict=False) if own == pin]
        if len(owners) > 1:
            problems.append(f"{quote_value(pin)} is the input of {join_words(owners)}")
        if board and pin not in available:
            problems.append(f"{quote_value(pin)} is no free analog input of {board.name}")
        elif not board and not _PIN.fullmatch(pin):
            problems.append(f"{quote_value(pin)} is no free analog input")

    usual = ",".join((available or ("A0", "A1"))[: len(signals)])
    issues += (Issue("--inputs", f"{problem}; give --inputs {usual}.") for problem in problems)
    return pins
