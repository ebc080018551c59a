"""Benchmark of slip detectors: folders of recordings, public layouts, scores, and the command."""

from __future__ import annotations

import json
import re
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from benchmarks.slip import real, real_sets, record
from benchmarks.slip.__main__ import main
from benchmarks.slip.baselines import adapt
from benchmarks.slip.bench import measure, select
from benchmarks.slip.competitors import COMPETITORS, Row, list_rows, load_own
from benchmarks.slip.curve import CurvePoint, Panel, at_rate, best_points, draw
from benchmarks.slip.mix_signals import LabelledSignal, Slide, draw_band_noise
from benchmarks.slip.own_sets import JUDGING, TUNING, Generated
from benchmarks.slip.public_sets import LAYOUTS, read_layout, unfold
from benchmarks.slip.recordings import Recording, Stretch, read_folder
from benchmarks.slip.run import ReadSet, read_options
from benchmarks.slip.scores import Tally, assess, share_interval
from fingertip.design import Design
from fingertip.foundation.errors import FingertipError, TraceError
from fingertip.slip.traces.truth import Interval

RATE_HZ = 2000.0
WAVE = np.round(300.0 * np.sin(0.02 * np.arange(4400)) + 100.0 * np.sin(0.13 * np.arange(4400)))
"""Pressure of a BioTac, before its set folds it."""
LABELS = "file,kind,start_s,end_s,motion_s\none.csv,quiet,0.2,1.2,\none.csv,slip,1.5,2.0,1.49\none.csv,tap,2.4,2.5,\n"  # noqa: E501


def write_recording(folder: Path, labels: str = LABELS, name: str = "one.csv") -> None:
    """Write 3 s of noise with a burst of 20 mV from 1.5 to 2 s, and its labels."""
    rng = np.random.default_rng(3)
    time_s = np.arange(round(3 * RATE_HZ)) / RATE_HZ
    volts = 1.0 + 4e-4 * rng.standard_normal(len(time_s))
    inside = (time_s >= 1.5) & (time_s < 2.0)
    volts[inside] += 0.02 * draw_band_noise(rng, int(inside.sum()), RATE_HZ, 40.0, 200.0)
    rows = (f"{t:.4f},{v:.6f}\n" for t, v in zip(time_s, volts, strict=True))
    (folder / name).write_text("time_s,voltage_v\n" + "".join(rows))
    (folder / "labels.csv").write_text(labels)


def test_a_folder_is_read_with_its_labels(tmp_path: Path) -> None:
    write_recording(tmp_path)
    (tmp_path / "bench.toml").write_text('title = "mine"\nrises_with_force = false\nscale = 2\n')
    found = read_folder(tmp_path)
    (one,) = found.recordings
    assert (found.title, one.signal.rate_hz, one.signal.slides) == (
        "mine",
        RATE_HZ,
        (Slide(1.49, 1.5, 2.0),),
    )
    assert [stretch.kind for stretch in one.stretches] == ["quiet", "tap"]
    assert one.rest is not None
    assert len(one.rest) == RATE_HZ
    assert 1.9 < one.signal.voltage_v[0] < 2.1
    # The article's board falls with the force, the default one rises: the signal is turned for the
    # latter.
    assert (
        adapt(Design.load("article"), one)[1].signal.voltage_v[0]
        > 0.0
        > adapt(Design(), one)[1].signal.voltage_v[0]
    )


@pytest.mark.parametrize(
    ("labels", "settings", "said"),
    [
        (
            "one.csv,slip,1.5,3.5\n",
            "",
            "labels.csv, one.csv: slip from 1.5 to 3.5 s does not lie within the recording",
        ),
        (
            "one.csv,shake,1,2\none.csv,slip,x,2\n",
            "",
            "'shake' is not a kind of stretch; choose among slip, quiet",
        ),
        ("one.csv,shake,1,2\none.csv,slip,x,2\n", "", "line 3: has a time that is not a number"),
        (
            "one.csv,slip,0.4,2\n",
            "",
            "one.csv: a slip begins at 0.4 s, while detectors still learn the noise",
        ),
        (
            "one.csv,slip,1,2\none.csv,quiet,1.5,1.7\n",
            "",
            "slip from 1 to 2 s and quiet from 1.5 to 1.7 s overlap",
        ),
        (
            "one.csv,slip,1,2\none.csv,slip,1.9,2.5\n",
            "",
            "overlap; let one end where the other begins",
        ),
        ("one.csv,slip,2,1.5\n", "", "line 2: ends at 1.5 s and begins at 2 s"),
        ("one.csv,slip,1\n", "", "line 2: has 3 cells; give 4"),
        ("../one.csv,slip,1,2\n", "", "does not name a file of this folder"),
        ("two.csv,slip,1,2\n", "", "two.csv: cannot be read (No such file or directory)"),
        ("one.csv,quiet,1,2\n", "", "holds no slip; label one"),
        ("", "", "holds no recording of this layout"),
        (LABELS.split("\n", 1)[1], "", "line 2: has 5 cells; give 4"),
        (
            "one.csv,slip,1,2\n",
            "rate = 5\nscale = true\n",
            "rate: is not known; choose among title, rate_hz",
        ),
        (
            "one.csv,slip,1,2\n",
            "rate = 5\nscale = true\n",
            "scale: True is not a number; correct it.",
        ),
        (
            "one.csv,slip,1,2\n",
            "columns = {voltage_v = 1}\n",
            "columns: gives a name for each column",
        ),
        ("one.csv,slip,1,2\n", "columns = [\n", "bench.toml: is not TOML"),
    ],
)
def test_each_fault_of_a_folder_is_named(
    labels: str, settings: str, said: str, tmp_path: Path
) -> None:
    write_recording(tmp_path, "file,kind,start_s,end_s\n" + labels)
    (tmp_path / "bench.toml").write_text(settings)
    with pytest.raises(TraceError) as refused:
        read_folder(tmp_path)
    assert said in str(refused.value)


def test_options_are_refused_together() -> None:
    with pytest.raises(FingertipError) as refused:
        read_options(None, layout="mine", detectors="fast,slow", own=Path("nothing.py"), share=2.0)
    with pytest.raises(FingertipError, match="share: draws from the project's own signals"):
        read_options(Path(), layout=None, detectors=None, own=None, share=0.5)
    text = str(refused.value)
    assert "detectors: 'slow' is not known; choose among fast, incipient" in text
    assert (
        "layout: 'mine' is not known; choose among natural_texture (a fingertip on a stage" in text
    )
    assert "layout: describes a folder" in text
    assert (
        "own: nothing.py is not a Python file; give one with find_statistic and THRESHOLD." in text
    )
    assert "share: 2 is out of bounds; choose 0.05 to 1." in text


def make_stage(folder: Path) -> None:
    """Write what R. V. Grigorii publishes.

    10 kHz, five columns; the stage moves in air, rests, and moves in touch.
    """
    counts = np.zeros(50_000)
    normal_v = np.full(50_000, 5.3)
    counts[5000:15_000] = -8 * np.arange(10_000)
    counts[15_000:] = counts[14_999]
    counts[30_000:40_000] += 8 * np.arange(10_000)
    counts[40_000:] = counts[39_999]
    normal_v[18_000:44_000] = 3.7
    table = np.zeros((50_000, 5))
    table[:, 0] = 1e-3 * np.random.default_rng(1).standard_normal(50_000)
    table[:, 1] = normal_v
    table[:, 4] = np.where(counts < 0, counts + 2.0**32, counts)
    savemat(folder / "data_temp.mat", {"dataQ": table})


def make_biotac(folder: Path, still: int = 160) -> None:
    """Write what R. Gao et al. publish.

    22 pressures a row of 10 ms, folded; rest, slide, motion in air.
    """
    place = folder / "raw_data/mat1"
    place.mkdir(parents=True)
    pressures = [f"pac{i}" for i in range(1, 23)]
    wave = np.abs(WAVE).reshape(-1, 22)
    lines = [",".join(["timestamp", "pdc", *pressures])]
    lines += [
        ",".join(
            [f"{1000 + 0.01 * row:.4f}", "3" if row < 180 else "0", *(f"{x:g}" for x in values)]
        )
        + ","
        for row, values in enumerate(wave)
    ]
    (place / "mat1_1_bio.csv").write_text("\n".join(lines) + "\n")
    moves = [
        f"{1000 + 0.005 * row:.4f},{0.025 * 0.005 * max(row - still, 0):.6f},0,0,0,0,0,1,"
        for row in range(400)
    ]
    (place / "mat1_1_cp.csv").write_text(
        "timestamp,posx,posy,posz,ox,oy,oz, ow\n" + "\n".join(moves) + "\n"
    )


def make_cluster(folder: Path, suffix: str = ".csv") -> None:
    """Write what M. Eguchi et al. publish: uneven times, the force in N, the position in mm."""
    tables = {
        "force": {
            "time": np.cumsum(np.tile((0.00021, 0.00013), 6000)),
            "force": np.full(12_000, 1.0),
        },
        "position": {
            "time": np.arange(204) / 100,
            "X": np.maximum(0.0, np.arange(204) - 100) * 0.4,
            "Y": np.zeros(204),
        },
    }
    for name, columns in tables.items():
        place = folder / "sensor_data" / name / "0"
        place.mkdir(parents=True)
        path = place / f"0_135_40_500_0{suffix}"
        if suffix == ".csv":
            np.savetxt(
                path,
                np.stack(list(columns.values()), 1),
                delimiter=",",
                header=",".join(columns),
                comments="",
            )
        else:
            pyarrow = pytest.importorskip("pyarrow")
            pytest.importorskip("pyarrow.parquet").write_table(pyarrow.table(columns), path)


def make_piezo(folder: Path) -> None:
    """Write what the authors publish: eight columns of volts without names and times, 2 kHz."""
    table = 1.82 + 1e-3 * np.random.default_rng(2).standard_normal((4000, 8))
    np.savetxt(folder / "Sensor_T1.lvm", table, delimiter="\t", fmt="%.16f")
    (folder / "labels.csv").write_text(
        "file,kind,start_s,end_s\nSensor_T1.lvm,quiet,0,1\nSensor_T1.lvm,slip,1.2,1.4\n"
    )


@pytest.mark.parametrize(
    ("layout", "make", "rate_hz", "slip_s", "quiet_s"),
    [
        ("natural_texture", make_stage, 10_000.0, (3.0, 4.0), 1.0),
        ("biotac_slide", make_biotac, 2200.0, (0.8, 1.8), 0.7),
        ("cluster_texture", make_cluster, 6000.0, (1.0, 2.0), 0.9),
        ("cluster_texture", partial(make_cluster, suffix=".parquet"), 6000.0, (1.0, 2.0), 0.9),
        ("piezo_onset", make_piezo, 2000.0, (1.2, 1.4), 1.0),
    ],
)
def test_public_sets_are_read_in_their_published_form(
    layout: str,
    make: object,
    rate_hz: float,
    slip_s: tuple[float, float],
    quiet_s: float,
    tmp_path: Path,
) -> None:
    assert callable(make)
    make(tmp_path)
    (one,) = read_layout(layout, tmp_path).recordings
    assert one.signal.rate_hz == pytest.approx(rate_hz)
    (slide,) = one.signal.slides
    assert (slide.onset_s, slide.end_s) == pytest.approx(slip_s, abs=0.06)
    assert one.rest is not None
    assert len(one.rest) / rate_hz == pytest.approx(quiet_s, abs=0.15)


def test_a_folded_pressure_is_unfolded() -> None:
    found = unfold(np.abs(WAVE))
    # Samples at a crossing.
    assert min(np.count_nonzero(found != WAVE), np.count_nonzero(found != -WAVE)) < 10


def test_a_set_that_begins_in_the_slide_is_refused(tmp_path: Path) -> None:
    make_biotac(tmp_path, still=0)
    with pytest.raises(TraceError, match=r"no recording rests for 0\.5 s before its first slip"):
        read_layout("biotac_slide", tmp_path)


@pytest.mark.parametrize("layout", LAYOUTS)
def test_a_folder_of_another_layout_is_refused(layout: str, tmp_path: Path) -> None:
    with pytest.raises(
        TraceError, match=r"holds no recording of this layout|labels\.csv: is missing"
    ):
        read_layout(layout, tmp_path)
    make_biotac(tmp_path)
    if layout == "biotac_slide":
        (tmp_path / "raw_data/mat1/mat1_1_cp.csv").write_text("timestamp,x\n1,2\n")
        with pytest.raises(TraceError, match="has no column 'posx'"):
            read_layout(layout, tmp_path)


def on_in(*parts: tuple[float, float], seconds: float = 4.0) -> np.ndarray:
    flags = np.zeros(round(seconds * RATE_HZ), dtype=bool)
    for start_s, end_s in parts:
        flags[round(start_s * RATE_HZ) : round(end_s * RATE_HZ)] = True

    return flags


def known(*events: Interval, slides: tuple[Slide, ...] = (Slide(0.98, 1.0, 1.5),)) -> Recording:
    signal = LabelledSignal("a", RATE_HZ, np.zeros(round(4 * RATE_HZ)), slides, events, 0.5)
    return Recording(signal, (Stretch("tap", 2.2, 2.25), Stretch("unsure", 3.1, 4.0)))


def test_alarms_and_delays_are_counted_where_they_belong() -> None:
    parts = ((0.1, 0.2), (1.02, 1.5), (1.6, 1.65), (2.3, 2.4), (2.7, 2.8), (3.2, 3.3))
    found = assess(known(Interval(2.2, 2.25)), on_in(*parts))
    assert found.delays_s == pytest.approx([0.02])
    assert found.on_shares == pytest.approx([0.96])
    # 0.1 s: before alarms count. 1.6 s: behind the slip. 2.3 s: the tap's reaction. 2.7 s: nothing
    # is labelled. 3.2 s: not sure.
    assert found.alarms == {"tap": 1, "unlabelled": 1, "unsure": 1}
    assert (found.counted, found.events, found.taken) == (2, 1, 1)
    assert found.minutes == pytest.approx((3.5 - 0.52 - 0.9) / 60)


@pytest.mark.parametrize(
    ("begin_s", "delay_s"),
    [(0.974, None), (0.976, 0.0), (1.0, 0.0), (1.1, 0.1), (1.199, 0.199), (1.201, None)],
)
def test_a_slip_is_found_from_its_motion_to_a_fifth_of_a_second_later(
    begin_s: float, delay_s: float | None
) -> None:
    found = assess(known(), on_in((begin_s, 1.4)))
    assert found.delays_s == ([] if delay_s is None else [pytest.approx(delay_s, abs=0.001)])


def test_each_window_of_rest_may_be_found_by_chance() -> None:
    parts = [(start_s, start_s + 0.1) for start_s in (1.0, 2.0, 3.0)]
    found = assess(known(slides=()), on_in(*parts))
    assert (found.found_windows, found.windows) == (3, 17)
    # In a recording with a slip, nothing is found by chance.
    assert assess(known(), on_in(*parts)).windows == 0


def test_an_event_beside_a_slip_does_not_count() -> None:
    flags = on_in((1.02, 1.5))
    assert assess(known(Interval(0.7, 0.79)), flags).events == 0
    assert assess(known(Interval(0.6, 0.7)), flags).events == 1


def test_a_share_has_the_interval_of_wilson() -> None:
    # E. B. Wilson's interval for 9 of 10, as statsmodels computes it.
    assert share_interval(9, 10) == pytest.approx([0.5958, 0.9821], abs=2e-4)
    assert share_interval(0, 0) == [0.0, 1.0]
    assert share_interval(0, 50)[0] == 0.0


def test_a_curve_joins_the_points_that_no_other_one_beats() -> None:
    points = [
        CurvePoint(factor, alarms, delay_ms, 2 * delay_ms)
        for factor, alarms, delay_ms in ((0.5, 9.0, 5.0), (1.0, 0.8, 10.0), (2.0, 0.9, 20.0))
    ]
    assert best_points(points, 0.5) == [points[1], points[0]]
    assert at_rate(points, 1.0, minutes=10.0) == points[1]
    assert at_rate(points, 0.1, minutes=100.0) is None
    assert at_rate(points, 1.0, minutes=0.5) is None, "half a minute shows no rate of 1"
    picture = draw([Panel("mine", 0.9, {Row("fast"): points})], 0.1).decode()
    assert picture.startswith("<svg")
    assert picture.count("<circle") == 1
    assert "fast, on" in picture


@pytest.mark.parametrize("name", COMPETITORS)
def test_each_detector_finds_a_strong_slip(name: str) -> None:
    (row,) = list_rows([name], has_rest=False)
    source = Generated("slip at constant force", "S", 5, 0.1)
    found = measure(Design(), [row], [source], (0.7, 1.0, 4.0))
    tallies = [select(found, row, factor).whole() for factor in (0.7, 1.0, 4.0)]
    best = max(tally.found_share for tally in tallies)
    assert best > 0.85
    # A higher threshold finds fewer slips, or the same later.
    assert tallies[-1].quantile_ms(0.5) > min(tally.quantile_ms(0.5) for tally in tallies[:2])


def test_a_baseline_takes_the_noise_from_the_end_of_the_stated_rest() -> None:
    rng = np.random.default_rng(4)
    rest = rng.standard_normal(8000)
    rest[:6000] *= 30.0
    loud = 10.0 * rng.standard_normal(4000)
    recording = Recording(LabelledSignal("a", RATE_HZ, loud), (), 1e-3 * rest)
    short, long = list_rows(["digital"])
    (with_short,) = short.run(Design(), recording, (1000.0,))
    (with_long,) = long.run(Design(), recording, (1000.0,))
    assert with_short.mean() > 0.9
    assert not with_long.any()
    assert [row.name for row in list_rows(["fast", "digital"])] == ["fast", "digital", "digital"]


def test_both_halves_of_a_set_are_apart_and_whole(tmp_path: Path) -> None:
    paths = [tmp_path / f"{number}_HOLD.mat" for number in range(10)]
    halves = [real_sets.divide(paths, half) for half in (TUNING, JUDGING)]
    assert sorted(halves[0] + halves[1]) == sorted(paths)
    assert len(halves[0]) == len(halves[1]) == 5


def make_sets(folder: Path) -> None:
    """Write four grasps and a stage; slides and hits are missing."""
    rng = np.random.default_rng(6)
    for number in range(4):
        fingers = {f"F{k}pac": rng.normal(2000.0, 3.0, (22, 1000)) for k in (0, 1)}
        savemat(folder / f"{number}_HOLD.mat", fingers)


def test_a_set_that_is_missing_is_named(tmp_path: Path) -> None:
    make_sets(tmp_path)
    with pytest.raises(TraceError) as refused:
        real_sets.list_real(tmp_path, JUDGING)
    assert "download the set of slides" in str(refused.value)
    assert "download the set of hits" in str(refused.value)
    assert "grasps" not in str(refused.value)


def test_a_slide_follows_the_rest_of_a_grasp_at_each_strength(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    make_sets(tmp_path)
    count = round(real_sets.SLIDE_S * real_sets.RATE_HZ)
    slide = np.random.default_rng(7).standard_normal(count)
    pieces = [real_sets.Piece((tmp_path / "a.csv",), slide)]
    monkeypatch.setattr(real_sets, "load_slides", lambda folder, half: pieces)
    at = round(real_sets.JOINED_S * real_sets.RATE_HZ)
    grasp = real_sets.load_grasps(tmp_path, TUNING)[0].values
    found = list(real_sets.read_slides(tmp_path, TUNING))
    assert [one.signal.kind for one in found] == ["slide full", "slide half", "slide quarter"]

    for one, strength in zip(found, real_sets.STRENGTHS.values(), strict=True):
        values = one.signal.voltage_v
        assert np.array_equal(values[:at], grasp[:at])
        assert one.rest is not None
        added = real_sets.band_rms(values[at:] - grasp[at : len(values)], real_sets.RATE_HZ)
        assert added == pytest.approx(strength * real_sets.band_rms(one.rest, real_sets.RATE_HZ))


def test_a_file_that_is_not_the_stated_one_is_told(tmp_path: Path) -> None:
    make_sets(tmp_path)
    (files,) = real.hash_sets([real_sets.RealSet(tmp_path, "grasps", JUDGING)]).values()
    assert (files["files"], files["is_stated"]) == (2, False)


def test_hits_are_found_where_they_are_isolated() -> None:
    rng = np.random.default_rng(8)
    values = rng.normal(0.0, 1.0, 8000 * 4)
    decay = np.exp(-np.arange(400) / 100) * np.sin(0.3 * np.arange(400))
    for at_s in (0.5, 1.5, 1.6, 3.0):  # the second one is followed by the third
        values[round(at_s * 8000) :][:400] += 3000 * decay

    found = real_sets._find_hits(values, 8000)
    assert [at / 8000 for at in found] == pytest.approx([0.5, 3.0], abs=0.004)
    assert np.abs(real_sets._cut_hit(values, found[0], 8000)).max() == pytest.approx(1.0)


def test_a_record_tells_slides_from_other_beginnings_of_on(tmp_path: Path) -> None:
    rng = np.random.default_rng(9)
    volts = 1.0 + 4e-4 * rng.standard_normal(12_000)
    volts[4000:6000] += 0.02 * draw_band_noise(rng, 2000, RATE_HZ, 40.0, 200.0)
    volts[9000:11_000] += 0.02 * draw_band_noise(rng, 2000, RATE_HZ, 40.0, 200.0)
    signal = LabelledSignal("slide", RATE_HZ, volts, (Slide(2.0, 2.0, 3.0),), (), 0.5)
    source = ReadSet([Recording(signal, (), design=Design.load("article"))])
    made = record.make_record([source], {"half": "mine"})
    assert made["card"] == {"half": "mine"}
    strong = made["classes"][-1]
    assert (strong["class"], strong["slides"], strong["others"]) == ("strong", 1, 1)
    assert strong["others_by_signal"] == {"slide": 1}
    assert 0.0 < strong["delays_ms"][1] < 50.0


def test_the_goals_are_judged_by_what_was_reached() -> None:
    late = Tally(slips=10, delays_s=[0.02] * 10, on_shares=[0.99] * 10)
    assert late.quantile_ms(0.9) == pytest.approx(20.0)
    goal = real.goals.Goal("p90", late.quantile_ms(0.9), 15.0, unit=" ms")
    assert not goal.is_met
    assert goal.describe() == "| p90 | at most 15 ms | 20 ms | **no** |"
    assert real.goals.Goal("ON", late.on_share, 0.98, is_least=True).is_met


def test_the_command_compares_detectors_on_a_folder(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_recording(tmp_path)
    own = tmp_path / "steps.py"
    own.write_text(
        "import numpy as np\nTHRESHOLD = 0.004\n\n"
        "def find_statistic(voltage_v, filtered_v, rate_hz, quiet_v):\n"
        "    assert filtered_v is None and len(quiet_v) in (0.3 * rate_hz, rate_hz)\n"
        "    return np.abs(np.diff(voltage_v, prepend=voltage_v[:1]))\n"
    )
    words = [str(tmp_path), "--detectors", "digital,cusum", "--own", str(own), "--json"]
    main([*words, "--out", str(tmp_path / "o")])
    done = capsys.readouterr()
    data = json.loads(done.out)
    assert data == json.loads((tmp_path / "o/slip_bench.json").read_text())
    assert [row["label"] for row in data["rows"][::2]] == [
        "the article's chain, rest 0.3 s",
        "CUSUM, rest 0.3 s",
        "steps, rest 0.3 s",
    ]
    assert data["rows"][0]["found"] == 1
    assert 2.0 < data["rows"][0]["median_ms"] < 25.0
    assert (tmp_path / "o/slip_curve.svg").read_bytes()[:4] == b"<svg"
    text = (tmp_path / "o/slip_bench.txt").read_text()
    assert "1 slips, 0.0 min without slip" in text
    assert "are too short to show 0.1 or 1 alarms a minute" in text
    assert "warning" not in done.err


def test_hum_in_a_recording_is_told_by_its_name(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_recording(tmp_path)
    rows = np.loadtxt(tmp_path / "one.csv", delimiter=",", skiprows=1)
    rows[:, 1] += 0.01 * np.sin(2 * np.pi * 50 * rows[:, 0])
    np.savetxt(
        tmp_path / "one.csv",
        rows,
        fmt="%.6f",
        delimiter=",",
        header="time_s,voltage_v",
        comments="",
    )
    main([str(tmp_path), "--detectors", "cusum", "--out", str(tmp_path / "o")])
    assert "one.csv: hum of 7.1 mV RMS at 50 Hz" in capsys.readouterr().err


def test_an_own_detector_that_cannot_be_used_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "mine.py"
    for text, said in (
        ("THRESHOLD = 1.0\n", "has no attribute 'find_statistic'"),
        ("def find_statistic(*_): return 1\n", "has no attribute 'THRESHOLD'"),
        ("x =\n", "cannot be used (SyntaxError"),
    ):
        path.write_text(text)
        with pytest.raises(TraceError, match=re.escape(said)):
            load_own(path)
    path.write_text("THRESHOLD = 1.0\ndef find_statistic(*_): return [1.0]\n")
    recording = Recording(
        LabelledSignal("a", RATE_HZ, np.zeros(4000), (Slide(0.98, 1.0, 1.5),)), ()
    )
    with pytest.raises(TraceError, match=r"returned \(1,\) for 4000 samples"):
        list(load_own(path).run(Design(), recording, (1.0,)))
    path.write_text("THRESHOLD = 1.0\ndef find_statistic(volts, *_): return volts[::-1]\n")
    volts = np.random.default_rng(1).normal(size=4000)
    recording = Recording(LabelledSignal("a", RATE_HZ, volts, (Slide(0.98, 1.0, 1.5),)), ())
    with pytest.raises(TraceError, match="it looks ahead; use this sample and earlier ones alone"):
        list(load_own(path).run(Design(), recording, (1.0,)))
