"""Examples on the help pages: each is a command to copy, and a test runs it."""

from __future__ import annotations

EXAMPLES: dict[str, tuple[str, ...]] = {
    "": (
        "fingertip make fsr400",
        "fingertip new myfinger --sensor fsr402",
        "fingertip detect out/fsr400/signal/trace.csv",
    ),
    "new": (
        "fingertip new myfinger --sensor fsr402",
        "fingertip new mytip --preset adult_finger --hand flexible_flyer",
    ),
    "params": ("fingertip params fsr402", "fingertip params fsr400 --set skin.width_mm=18 --toml"),
    "schema": ("fingertip schema design", "fingertip schema sweep"),
    "make": ("fingertip make fsr400", "fingertip make fsr400 --set skin.width_mm=18 --out out/wider"),
    "build": (
        "fingertip build fsr400 --formats stl",
        "fingertip build fsr400 --set skin.width_mm=18 --set name=wider --formats stl,3mf",
    ),
    "check": (
        "fingertip check fsr400 fsr402 --junit out/checks.xml",
        "fingertip check fsr400 --verbose",
        "fingertip check out/fsr400",
    ),
    "picture": ("fingertip picture fsr400", "fingertip picture adult_finger --filling --out filling.png"),
    "drawing": ("fingertip drawing adult_finger --out out/adult_drawing",),
    "page": ("fingertip page fsr400",),
    "studio": ("fingertip studio fsr400", "fingertip studio mine.toml --port 0 --no-browser"),
    "sheet": ("fingertip sheet fsr400", "fingertip sheet fsr400 --material smooth_sil_940 --out casting.md"),
    "acceptance": ("fingertip acceptance fsr400 --out acceptance.md",),
    "coupon": ("fingertip coupon fsr400",),
    "calibrate": (
        "fingertip calibrate printer fsr400 my_readings.toml --out calibrated.toml",
        "fingertip calibrate sensor my_weighings.csv article --out weighed.toml",
    ),
    "calibrate printer": ("fingertip calibrate printer fsr400 my_readings.toml --out calibrated.toml",),
    "calibrate sensor": ("fingertip calibrate sensor my_weighings.csv article --out weighed.toml",),
    "board": (
        "fingertip board fsr400",
        "fingertip board fsr400 --analysis --plot response.svg --out out/board",
        "fingertip board article --article --out out/article_board",
        "fingertip board fsr400 --check",
    ),
    "firmware": ("fingertip firmware fsr400",),
    "simulate": (
        "fingertip simulate fsr400 --surface smooth --seed 7 --out smooth.csv",
        "fingertip simulate hard_tap --design fsr400 --set tap.force_n=3 --out tap.csv",
    ),
    "detect": (
        "fingertip detect smooth.csv --detector fast",
        "fingertip detect daq.csv --column time_s='Time [s]' --column voltage_v='AI0 (V)'",
    ),
    "validate": ("fingertip validate fsr400 --trials 12 --minutes 1",),
    "sweep": ("fingertip sweep board --out out/sweep", "fingertip sweep --show --out out/sweep"),
    "bench": ("fingertip bench --solvers odeint --seconds 1 --boards 100",),
    "completion": ("fingertip completion bash",),
}
"""Command -> commands to copy."""


def list_examples(command: str) -> tuple[str, ...]:
    """List the examples of a command; of the whole program for an empty name."""
    return EXAMPLES.get(command, ())
