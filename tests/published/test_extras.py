"""Each extra alone, in an environment of its own: what it is
advertised for works, and broken input is refused.
"""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tests.conftest import ROOT
from tests.published.conftest import Installation, run

pytestmark = pytest.mark.full


def use_cadquery(place: Installation) -> None:
    place.accepts("build", "valid.toml", "--parts", "bone", "--formats", "step", "--out", "parts")
    assert (place.folder / "parts" / "bone.step").stat().st_size
    place.refuses("build", "broken.toml", "--formats", "step", "--out", "refused")


def use_mesh(place: Installation) -> None:
    place.accepts("check", "valid.toml", "--verify")
    place.accepts(
        "build",
        "valid.toml",
        "--parts",
        "bone",
        "--formats",
        "stl,3mf",
        "--verify",
        "--out",
        "parts",
    )
    for name in ("bone.stl", "bone.3mf"):
        assert "all" in place.accepts("check", f"parts/{name}")
    place.python(
        'import fingertip; assert fingertip.part_trimesh(fingertip.Design(), "bone").volume > 0'
    )
    place.refuses("check", "broken.toml", "--verify")


def use_plots(place: Installation) -> None:
    place.accepts("simulate", "valid.toml", "--out", "trace.csv", "--plot", "trace.png")
    assert (place.folder / "trace.png").stat().st_size
    place.refuses("simulate", "broken.toml", "--out", "refused.csv", "--plot", "refused.png")


SWEEP = """
name = "sobol"
outputs = ["cutoff_3db_hz"]
sampling = "sobol"
points = 8
[axes]
board.cutoff_hz = { low = 60, high = 75 }
"""


def use_sweep(place: Installation) -> None:
    (place.folder / "sobol.toml").write_text(SWEEP)
    place.accepts("sweep", "sobol.toml", "--jobs", "1", "--out", "sobol")
    place.python(
        "import numpy, scipy.io\n"
        "time_s = numpy.arange(8000) / 2000\n"
        'scipy.io.savemat("trace.mat", {"time_s": time_s, "voltage_v": 2 + 0.01 * '
        "numpy.sin(time_s)})\n"
    )
    place.accepts("detect", "trace.mat")
    (place.folder / "broken_sweep.toml").write_text(SWEEP.replace("points = 8", "points = -8"))
    place.refuses("sweep", "broken_sweep.toml", "--out", "refused")


def use_fast(place: Installation) -> None:
    done = place.fingertip(
        "validate", "valid.toml", "--trials", "2", "--minutes", "0.5", check=True
    )
    assert "compiled loops" not in done.stderr, "they are not left out"
    place.refuses("validate", "broken.toml", "--trials", "2", "--minutes", "0.5")


def use_drawing(place: Installation) -> None:
    place.accepts("drawing", "valid.toml", "--out", "drawings")
    place.refuses("drawing", "broken.toml", "--out", "refused")


def detect_file(place: Installation, name: str, write: str) -> None:
    """Write a recording by code that has `time_s` and `voltage_v`,
    detect slip in it, and refuse a damaged one.
    """
    place.python(
        "import numpy\n"
        "time_s = numpy.arange(8000) / 2000\n"
        "voltage_v = 2 + 0.001 * numpy.random.default_rng(1).normal(size=8000)\n" + write
    )
    place.accepts("detect", name)
    whole = (place.folder / name).read_bytes()
    (place.folder / f"broken_{name}").write_bytes(whole[: len(whole) // 2])
    place.refuses("detect", f"broken_{name}")


def use_parquet(place: Installation) -> None:
    detect_file(
        place,
        "trace.parquet",
        "import pyarrow, pyarrow.parquet\n"
        'table = pyarrow.table({"time_s": time_s, "voltage_v": voltage_v})\n'
        'pyarrow.parquet.write_table(table, "trace.parquet")\n',
    )


def use_tdms(place: Installation) -> None:
    detect_file(
        place,
        "trace.tdms",
        "from nptdms import ChannelObject, TdmsWriter\n"
        'with TdmsWriter("trace.tdms") as file:\n'
        '    time, voltage = (ChannelObject("run", name, globals()[name]) for name in ("time_s", '
        '"voltage_v"))\n'
        "    file.write_segment([time, voltage])\n",
    )


def use_ros(place: Installation) -> None:
    place.python(
        "from rosbags.rosbag1 import Writer\n"
        "from rosbags.typesys import Stores, get_typestore\n"
        "store = get_typestore(Stores.ROS1_NOETIC)\n"
        'Number = store.types["std_msgs/msg/Float64"]\n'
        'with Writer("trace.bag") as bag:\n'
        '    topic = bag.add_connection("/voltage", Number.__msgtype__, typestore=store)\n'
        "    for i in range(8000):\n"
        "        data = store.serialize_ros1(Number(2.0 + 0.001 * (i * 7919 % 13 - 6)), "
        "Number.__msgtype__)\n"
        "        bag.write(topic, 10**9 + 500_000 * i, data)\n"
    )
    columns = ("--column", "time_s=/voltage.bag_time", "--column", "voltage_v=/voltage.data")
    assert " ".join(columns) in place.refuses("detect", "trace.bag"), "it proposes the columns"
    place.accepts("detect", "trace.bag", *columns)
    (place.folder / "broken.bag").write_bytes((place.folder / "trace.bag").read_bytes()[:2000])
    place.refuses("detect", "broken.bag")


def use_cluster(place: Installation) -> None:
    (place.folder / "grid.toml").write_text(
        'name = "grid"\noutputs = ["cutoff_3db_hz"]\n[axes]\nboard.cutoff_hz = [60, 67, 75]\n'
    )
    place.python(
        "import subprocess, sys\n"
        "from distributed import LocalCluster\n"
        "with LocalCluster(n_workers=1, processes=False, protocol='tcp', dashboard_address=None) "
        "as cluster:\n"
        "    words = ['sweep', 'grid.toml', '--out', 'grid', '--cluster', "
        "cluster.scheduler_address]\n"
        "    subprocess.run([sys.executable, '-m', 'fingertip', *words], check=True)\n"
    )
    assert (place.folder / "grid").is_dir()
    place.refuses("sweep", "grid.toml", "--out", "refused", "--cluster", "tcp://127.0.0.1:1")


def use_frames(place: Installation) -> None:
    place.python(
        "import numpy, fingertip\n"
        "frame = fingertip.Trace(numpy.arange(3.0), numpy.zeros(3)).to_dataframe()\n"
        "assert len(frame) == 3\n"
    )


WAYS: dict[str, Callable[[Installation], None]] = {
    "cadquery": use_cadquery,
    "mesh": use_mesh,
    "plots": use_plots,
    "sweep": use_sweep,
    "fast": use_fast,
    "drawing": use_drawing,
    "parquet": use_parquet,
    "tdms": use_tdms,
    "ros": use_ros,
    "cluster": use_cluster,
    "frames": use_frames,
}
"""Extra -> what it is advertised for."""


@pytest.mark.every_case
@pytest.mark.parametrize("extra", WAYS)
def test_extra_alone_does_what_it_is_advertised_for(
    extra: str, install: Callable[..., Installation]
) -> None:
    WAYS[extra](install(extra))


@pytest.mark.every_case
@pytest.mark.parametrize("kind", ["core", "usual", "all"])
def test_larger_installations_pass_their_smoke_test(
    kind: str, install: Callable[..., Installation]
) -> None:
    """Its limits of size are those of install.sh, which compiles nothing beforehand."""
    place = install("" if kind == "core" else kind, "--no-compile")
    done = run(ROOT / ".ci" / "smoke", place.bin.parent, kind, cwd=place.folder, check=False)
    assert done.returncode == 0, f"{done.stdout}\n{done.stderr}"
