"""The C detector against the Python one, here and on emulated controllers: the same bits, and
limits of its costs.
"""

from __future__ import annotations

import itertools
import subprocess
from pathlib import Path

import numpy as np
import pytest

from benchmarks.slip.mix_signals import filter_as_board
from fingertip.design import Design
from fingertip.firmware.c_sources import SOURCE, library_settings
from fingertip.firmware.measured_costs import read_costs
from fingertip.foundation import jit
from fingertip.slip.detectors.fast import FastDetector, FastOutput
from fingertip.slip.detectors.fast_decision import SHORT_RATIO
from tests.firmware.conftest import Library, make_library, require_arm, require_gcc
from tools.firmware.measure import measure
from tools.firmware.signals import Recording, campaign_recordings, count_differences, slip_recording
from tools.firmware.toolchain import (
    TARGETS,
    Target,
    TargetRun,
    compile_host,
    compile_target,
    run_target,
    tool_version,
    write_sources,
)

MIN_EQUAL_SHARE = 0.999
"""Share of the intervals that must agree within one sample in single precision."""


def python_detector(design: Design) -> FastDetector:
    return FastDetector(library_settings(design))


def single(volts: np.ndarray) -> np.ndarray:
    """Voltages as the library takes them."""
    with np.errstate(over="ignore"):
        return np.asarray(volts.astype(np.float32).astype(np.float64))


def assert_same_bits(library: Library, *inputs: np.ndarray) -> FastOutput:
    """The library gives the bits of Python's numbers, the floor of every sample included."""
    inputs = tuple(map(single, inputs))
    with jit.compiled():
        output = python_detector(library.design).process(*inputs)

    vibration, mean, floor, incipient, on, faults = library.detector().process(*inputs)
    assert np.array_equal(output.filtered_v, vibration)
    assert np.array_equal(output.statistic_v, mean)
    begun = mean > 0.0  # before the first tick Python states the threshold of the stated noise
    threshold = np.float32(SHORT_RATIO) * floor
    assert np.array_equal(output.threshold_v[begun], threshold[begun])
    assert np.array_equal(output.on, on)
    assert np.array_equal(output.incipient, incipient)
    assert np.array_equal(output.is_replaced + 2 * output.is_outside, faults & 3)
    return output


def random_signals(design: Design, count: int, seed: int = 1) -> dict[str, Recording]:
    """Signals of every kind: noise, bursts, steps, codes, limits, a broken wire, any size,
    constants.
    """
    random = np.random.default_rng(seed)
    tactile = 2.0 + random.normal(0.0, 4e-4, count)
    filtered = 1.5 + random.normal(0.0, 4e-4, count)
    blocks = -(-count // 1000)
    loudness = np.repeat(random.choice([1.0, 5.0, 30.0], blocks), 1000)[:count]
    forces = np.repeat(random.uniform(0.0, 3.0, blocks), 1000)[:count]
    step = design.detector.adc_step_v

    def any_size() -> np.ndarray:
        with np.errstate(over="ignore"):
            return random.normal(size=count) * 10.0 ** random.uniform(-320, 308, count)

    constant = np.full(count, 3.3)
    return {
        "noise": Recording(tactile, filtered),
        "bursts": Recording(
            2.0 + (tactile - 2.0) * loudness, 1.5 + (filtered - 1.5) * 100.0 * loudness
        ),
        "steps": Recording(tactile + forces, filtered + 0.1 * (forces - forces[0])),
        "slip": slip_recording(design, count / design.detector.sample_rate_hz),
        "stuck": Recording(np.where(np.arange(count) % 5000 < 1000, 2.0, tactile), filtered),
        "codes": Recording(*(np.round(volts / step) * step for volts in (tactile, filtered))),
        "limits": Recording(tactile, np.clip(1.5 + random.normal(0.0, loudness / 10), 0.0, 3.0)),
        "broken": Recording(tactile, np.where(np.arange(count) % 9000 < 4500, 1.5, filtered)),
        "any size": Recording(any_size(), any_size()),
        "constant": Recording(constant, constant),
        "zero": Recording(0.0 * constant, 0.0 * constant),
    }


@pytest.fixture(params=["library", "article_library"])
def either(request: pytest.FixtureRequest) -> Library:
    """Library with and without the board's filtered signal."""
    found: Library = request.getfixturevalue(request.param)
    return found


@pytest.mark.parametrize(
    "name",
    [
        "noise",
        "bursts",
        "steps",
        "slip",
        "codes",
        "limits",
        "broken",
        "stuck",
        "any size",
        "constant",
        "zero",
    ],
)
def test_the_library_has_the_bits_of_python(either: Library, name: str) -> None:
    recording = random_signals(either.design, 40_000)[name]
    output = assert_same_bits(either, recording.tactile_v)
    assert output.on.any() == (name in ("bursts", "slip")) or name == "any size"
    if recording.filtered_v is not None:
        assert_same_bits(either, recording.tactile_v, recording.filtered_v)


def test_infinite_and_missing_samples_do_the_same_in_both(library: Library) -> None:
    random = np.random.default_rng(3)
    for wrong in (np.inf, -np.inf, np.nan):
        volts = np.concatenate((random.normal(size=1000), [wrong], random.normal(size=3000)))
        for inputs in ((volts,), (volts, volts), (random.normal(size=4001), volts)):
            assert_same_bits(library, *inputs)
        assert not library.detector().process(volts, volts)[4][1100:].any()


@pytest.mark.full
@pytest.mark.parametrize("rate_hz", [1000.0, 1234.5, 5000.0, 20000.0])
def test_other_sampling_rates_give_the_same_bits(rate_hz: float, tmp_path: Path) -> None:
    design = Design(detector={"sample_rate_hz": rate_hz})
    library = make_library(design, tmp_path)
    output = assert_same_bits(library, *slip_recording(design, 3.0).inputs)
    assert output.on.any()


@pytest.mark.full
def test_float_finds_the_intervals_of_the_whole_campaign(either: Library) -> None:
    """The campaign's traces, and a thousand slips in noise, so that one difference is less than the
    limit.

    The library takes the codes of the converter, as on a controller.
    """
    design = either.design
    different = 0
    total = 0
    slips = (slip_recording(design, 4.0, seed) for seed in range(0, 2000, 2))
    with jit.compiled():
        for recording in itertools.chain(campaign_recordings(design), slips):
            output = python_detector(design).process(*recording.quantised(design).inputs)
            on = either.detector().process_codes(*recording.codes(design))
            wrong, found = count_differences(output.on, on)
            different = different + wrong
            total = total + found
    print(f"{design.board.variant}: {different} of {total} intervals differ")
    assert total > 2 / (1 - MIN_EQUAL_SHARE)
    assert different <= (1 - MIN_EQUAL_SHARE) * total


def test_float_does_not_depend_on_the_force_at_which_it_begins(library: Library) -> None:
    """A constant voltage costs no digits, as filters take differences: 16 V away, decisions stay
    the same.
    """
    step = 2.0**-14  # voltages that single precision holds exactly, here and there
    tactile, filtered = (
        np.round(each / step) * step for each in slip_recording(library.design, 4.0).inputs
    )
    near, far = (
        library.detector().process(tactile + offset, filtered + offset) for offset in (0.0, 16.0)
    )
    assert near[3].any()
    # 16 V is no voltage that a force gives.
    for values, others in zip(near[:-1], far[:-1], strict=True):
        assert np.array_equal(values, others)


@pytest.mark.full
@pytest.mark.parametrize("level", ["-O0", "-Os", "-O3"])
def test_compiles_without_warnings_whatever_the_optimisation(
    library: Library, level: str, tmp_path: Path
):
    """No number is converted silently, and no float is promoted to double."""
    write_sources(library.design, tmp_path)
    compile_host(
        tmp_path,
        level,
        "-Wconversion",
        "-Wdouble-promotion",
        "-Wshadow",
        "-Wstrict-prototypes",
    )


@pytest.mark.full
def test_sanitizers_find_no_undefined_behaviour(library: Library, tmp_path: Path) -> None:
    """A whole program: the sanitizers must be the first library of a process."""
    require_gcc()
    write_sources(library.design, tmp_path)
    program = tmp_path / "main.c"
    program.write_text(
        '#include "slip_detector.h"\n#include <stdio.h>\nint main(void) { static slip_state s; '
        "float v[2]; "
        "slip_init(&s); while (fread(v, sizeof v, 1, stdin) == 1) putchar(slip_step(&s, v[0], "
        "v[1])); return 0; }\n"
    )
    flags = [
        "-std=c99",
        "-g",
        "-fsanitize=undefined,address",
        "-fno-sanitize-recover=all",
        f"-I{tmp_path}",
    ]
    binary = tmp_path / "main"
    subprocess.run(
        ["gcc", *flags, str(program), str(tmp_path / SOURCE), "-o", str(binary)], check=True
    )
    inputs = [each.astype("<f4") for each in slip_recording(library.design, 3.0).inputs]
    done = subprocess.run(
        [str(binary)], input=np.column_stack(inputs).tobytes(), capture_output=True, check=True
    )
    assert not done.stderr
    assert np.array_equal(
        np.frombuffer(done.stdout, np.uint8) > 0, library.detector().process(*inputs)[4]
    )


@pytest.mark.second
@pytest.mark.parametrize("share", [1.0, 0.25])
def test_codes_are_judged_as_in_python_wherever_s_rests(share: float, tmp_path: Path) -> None:
    """Codes of a converter whose step is exact in binary; a quarter of S is one of 10 bits in a
    12-bit library.
    """
    design = Design(detector={"adc_range_v": 4.0})
    tactile, filtered = slip_recording(design, 4.0).codes(design)
    assert filtered is not None
    filtered = np.int32(share * filtered)
    step_v = design.detector.adc_step_v
    found = [
        FastDetector(library_settings(design, in_codes))
        .process(step_v * tactile, step_v * filtered)
        .on
        for in_codes in (True, False)
    ]
    on = make_library(design, tmp_path).detector().process_codes(tactile, filtered)
    assert np.array_equal(found[0], on)
    assert np.array_equal(found[0], found[1]) == (share == 1.0)


def test_codes_are_volts_without_rounding(either: Library) -> None:
    """The same decisions, and the same ones whatever the code at which the signal begins."""
    recording = slip_recording(either.design, 4.0)
    design = either.design
    codes = recording.codes(design)
    on = either.detector().process_codes(*codes)
    assert on.any()
    assert np.array_equal(
        on, python_detector(design).process(*recording.quantised(design).inputs).on
    )
    moved = [
        None if each is None else each + by
        for each, by in zip(codes, (12_345_678, 123), strict=True)
    ]
    assert np.array_equal(on, either.detector().process_codes(*moved))


def test_incipient_slip_is_that_of_python(library: Library) -> None:
    inputs = slip_recording(library.design, 3.0).inputs
    output = python_detector(library.design).process(*inputs)
    incipient = library.detector().process(*inputs)[3]
    assert np.array_equal(incipient, output.incipient)
    assert output.on.sum() < incipient.sum() < len(incipient)


by_target = pytest.mark.parametrize("target", TARGETS, ids=[target.name for target in TARGETS])
TOLERANCE = 0.02
"""Largest relative difference between two measurements with the same compiler: other samples of the
same kind.
"""


def run(library: Library, target: Target, recording: Recording, level: str = "-O2") -> TargetRun:
    require_arm()
    return run_target(compile_target(library.folder, target, level), target, recording)


@pytest.mark.full
@by_target
@pytest.mark.parametrize("level", ["-O2", "-Os"])
def test_decisions_are_those_of_this_machine(library: Library, target: Target, level: str) -> None:
    """Both compute single precision by IEEE 754, so the numbers have the same bits."""
    recording = slip_recording(library.design, 1.5)
    found = run(library, target, recording, level)
    on = library.detector().process(*recording.inputs)[4]
    assert len(found.on) == len(on)
    assert np.array_equal(found.on, on)
    assert 0.1 < on.mean() < 0.9


@pytest.mark.full
def test_products_and_sums_are_not_contracted_as_arduino_compiles(
    library: Library, tmp_path: Path
) -> None:
    """Arduino's options leave out -ffp-contract=off, so the source itself forbids it."""
    require_arm()
    source = (library.folder / "slip_detector.c").read_text()
    assert contracted(library, tmp_path, source) == 0
    assert contracted(library, tmp_path, source.replace("#pragma GCC optimize", "// ")) > 0


def contracted(library: Library, folder: Path, source: str) -> int:
    """Number of fused instructions in the code."""
    (folder / "source.c").write_text(source)
    image = folder / "source.o"
    flags = [*TARGETS[0].options, "-mthumb", "-Os", "-std=gnu11", f"-I{library.folder}", "-c"]
    subprocess.run(
        ["arm-none-eabi-gcc", *flags, str(folder / "source.c"), "-o", str(image)], check=True
    )
    done = subprocess.run(
        ["arm-none-eabi-objdump", "-d", str(image)], capture_output=True, text=True, check=True
    )
    return done.stdout.count("vfma") + done.stdout.count("vfms")


def assert_limits(data: dict) -> None:
    assert data["state_bytes"] <= 1200
    for target in data["targets"].values():
        assert target["flash_bytes"] <= 32 * 1024
        assert target["stack_bytes"] <= 640
    assert data["targets"]["Cortex-M4F"]["instructions"]["campaign"] <= 1000


def test_the_committed_measurements_are_within_the_limits() -> None:
    assert_limits(read_costs())


@pytest.mark.full
def test_the_committed_measurements_are_measured_again(library: Library) -> None:
    """With the compiler that made the table, the same bytes and nearly the same counts; else the
    limits alone.
    """
    require_arm()
    written = read_costs()
    found = measure(library.design, stride=48, seconds=2.0)
    assert_limits(found)
    if tool_version("arm-none-eabi-gcc") not in written["compiler"]:
        return
    assert found["state_bytes"] == written["state_bytes"]
    for name, target in found["targets"].items():
        expected = written["targets"][name]
        assert target["flash_bytes"] == expected["flash_bytes"]
        assert target["stack_bytes"] == expected["stack_bytes"]
        assert target["max_instructions"] == pytest.approx(
            expected["max_instructions"], rel=TOLERANCE
        )
        for signal in ("quiet", "slip"):
            assert target["instructions"][signal] == pytest.approx(
                expected["instructions"][signal], rel=TOLERANCE
            )
        assert target["instructions"]["campaign"] == pytest.approx(
            expected["instructions"]["campaign"], rel=0.1
        )


RECALL_PROGRAM = """
#include "slip_detector.h"
#include <stdio.h>
int main(void) {
    slip_state state;
    slip_floors floors = {0};
    const slip_floors blank = {0}; /* flash that was never written */
    float tactile_v, filtered_v;
    int i, begun, on[2] = {0};
    slip_init(&state);
    for (i = 0; scanf("%f %f", &tactile_v, &filtered_v) == 2; i++) {
        begun = i == 8000 || i == 9000;
        if (i == 8000) floors = slip_learned(&state);
        if (begun) slip_init(&state);
        if (begun) slip_recall(&state, i == 8000 ? blank : floors);
        if (slip_step(&state, tactile_v, filtered_v) && i >= 8000) on[i >= 9000]++;
    }
    printf("%d %d\\n", on[0], on[1]);
    return 0;
}
"""


def test_a_start_in_the_middle_of_a_slip_is_decided_with_stored_floors(tmp_path: Path) -> None:
    """Of two equal starts in vibration, the one that recalls the floors of a rest is ON; C counts
    as Python does.
    """
    require_gcc()
    random = np.random.default_rng(3)
    design = Design()
    slides = np.tile(0.004 * random.normal(0.0, 1.0, 1000), 2)
    volts = single(0.6 + random.normal(0.0, 2e-4, 10_000) + np.append(np.zeros(8000), slides))
    filtered = filter_as_board(design, volts)
    assert filtered is not None
    filtered = single(filtered)
    rested = FastDetector(library_settings(design))
    rested.process(volts[:8000], filtered[:8000])
    counts = []
    for part, floors in ((slice(8000, 9000), None), (slice(9000, 10_000), rested.floors)):
        detector = FastDetector(library_settings(design), floors=floors)
        counts.append(np.count_nonzero(detector.process(volts[part], filtered[part]).on))
    write_sources(design, tmp_path)
    (tmp_path / "main.c").write_text(RECALL_PROGRAM)
    sources = [str(tmp_path / name) for name in ("main.c", "slip_detector.c")]
    flags = ["-std=c99", "-ffp-contract=off", f"-I{tmp_path}"]
    subprocess.run(["gcc", *flags, *sources, "-o", str(tmp_path / "main")], check=True)
    lines = "\n".join(
        f"{t!r} {s!r}" for t, s in zip(volts.tolist(), filtered.tolist(), strict=True)
    )
    done = subprocess.run(
        [str(tmp_path / "main")], input=lines, capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == [str(count) for count in counts]
    assert counts[0] == 0
    assert counts[1] > 800
