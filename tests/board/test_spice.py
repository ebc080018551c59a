"""The SPICE deck in ngspice: transfer function, ripple, clamps, loads and noise."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fingertip.board.analysis.board_values import board_values
from fingertip.board.analysis.limits import adc_range_warnings
from fingertip.board.analysis.loads import compute_output_currents, load_warnings
from fingertip.board.analysis.noise import NETS, add_noise, noise_budget
from fingertip.board.analysis.response import decibel
from fingertip.board.circuits.board_circuit import board_circuit
from fingertip.board.circuits.network import build_network
from fingertip.board.components.front_end import sensor_conductance_s
from fingertip.board.components.values import SUPPLIES, VARIANT_CHANGES
from fingertip.design import Design
from fingertip.design.formulas.amplifiers import choose_amplifier, find_gain_bandwidth_hz
from fingertip.tasks.board_files import write_board
from tests.board.ngspice import read_noise_total, run_ngspice
from tests.designs import ARTICLE, load_article
from tests.oracles.filter_formulas import filter_transfer

DESIGNS = {
    "article": [],
    "another": [
        "board.cutoff_hz=120",
        "board.capacitor_uf=0.22",
        "board.passband_gain=21",
        "board.series=E96",
    ],
    "slow": ["board.cutoff_hz=5", "board.capacitor_uf=10"],
    "precision": ["board.variant=precision"],
    "precision, 500 Hz": ["board.variant=precision", "board.band_limit_hz=500"],
    "comparator": ["board.variant=comparator", "board.capacitor_series=E12"],
    "comparator, 90 Hz": ["board.variant=comparator", "board.cutoff_hz=90", "board.series=E96"],
}


def write_deck(folder: Path, changes: list[str]) -> tuple[Design, str]:
    design = load_article(changes)
    write_board(design, folder)
    return design, (folder / "slip_filter.cir").read_text(encoding="utf-8")


def max_deviation_db(folder: Path, design: Design, deck: str) -> float:
    """Maximum deviation of the deck from our transfer function [dB], from 1 Hz to 100 kHz."""
    rows = run_ngspice(
        folder,
        deck,
        "ac dec 40 1 100k\nwrdata out vr(tactile) vi(tactile) vr(filtered) vi(filtered)",
    )
    assert len(rows) > 200
    assert (rows[0][0], round(rows[-1][0])) == (1.0, 100_000)
    values = board_values(design)
    amplifier = choose_amplifier(design.board)
    arguments = (
        values.preferred,
        amplifier.bandwidth_hz,
        values.first_stage_capacitors,
        amplifier.input_f,
    )
    return max(
        abs(decibel(complex(fr, fi) / complex(tr, ti)) - decibel(filter_transfer(f, *arguments)))
        for f, tr, ti, fr, fi in rows
    )


@pytest.mark.parametrize("changes", DESIGNS.values(), ids=DESIGNS)
def test_deck_has_the_transfer_function_of_the_filter(tmp_path: Path, changes: list[str]) -> None:
    design, deck = write_deck(tmp_path, changes)
    assert max_deviation_db(tmp_path, design, deck) < 1e-2


# Effects that ideal formulas omit


def replace_elements(deck: str, **elements: str) -> str:
    """Return the deck with other lines in place of those of these elements."""
    for name, line in elements.items():
        old = next(candidate for candidate in deck.splitlines() if candidate.startswith(f"{name} "))
        deck = deck.replace(f"\n{old}\n", f"\n{line}\n")
    return deck


@pytest.mark.full
@pytest.mark.every_case
@pytest.mark.parametrize("name", VARIANT_CHANGES)
def test_supply_ripple_agrees_with_ngspice(tmp_path: Path, name: str) -> None:
    design, deck = write_deck(tmp_path, [*VARIANT_CHANGES[name]])
    ripple = board_values(design).supply_ripple
    is_article = name.startswith("article")
    sensor = deck[deck.index("RJ1 ") :].splitlines()[0].rsplit(" ", 1)[0]
    deck = replace_elements(
        deck, RJ1=f"{sensor} {1 / (sensor_conductance_s(ripple.force_n) or 1e-12):.10g}"
    )
    (source,) = (line for line in deck.splitlines() if line.startswith(("VJ2a ", "VJ3 ")))
    ripple_only = deck.replace(f"\n{source}\n", f"\n{source} ac 1\n").replace("dc 0 ac 1u", "dc 0")
    ground = "" if is_article else "-v(vmid)"
    rows = run_ngspice(
        tmp_path, ripple_only, f"ac dec 100 30 100k\nlet g = abs(v(filtered){ground})\nwrdata out g"
    )
    gains = {f: g for f, g, *_ in rows}
    worst_hz = max(gains, key=gains.__getitem__)
    assert ripple.gain == pytest.approx(gains[worst_hz], rel=0.002 if is_article else 0.01)
    assert ripple.worst_hz == pytest.approx(worst_hz, rel=0.05)
    assert (ripple.low_hz, ripple.high_hz) == (30, 100e3)
    # Without a low-pass (variant article) ripple of a switching converter counts more than that of
    # the mains.
    assert (worst_hz > 5000) == (is_article and "3v3" not in name)
    peak = 0.45 if is_article else math.pi * design.detector.threshold_v
    assert ripple.max_v == pytest.approx(peak / gains[worst_hz], rel=0.01)


@pytest.mark.every_case
@pytest.mark.parametrize("name", VARIANT_CHANGES)
def test_supply_ripple_is_worst_at_the_stated_force(name: str) -> None:
    design = load_article(VARIANT_CHANGES[name])
    values = board_values(design)
    for force_n in {0.0, 0.3, 1.0, 5.0, 20.0} - {values.supply_ripple.force_n}:
        network = build_network(board_circuit(values), 3e6, sensor_s=sensor_conductance_s(force_n))
        part = network.restrict("FILTERED", SUPPLIES[name].signal_ground)
        nets = [net for net in ("FILTERED", "VMID") if net in part.nets]
        volts = part.response(np.geomspace(30, 1e5, 300), {"VCC": 1.0}, *nets)
        assert np.abs(volts @ np.array([1.0, -1.0][: len(nets)])).max() < values.supply_ripple.gain


@pytest.mark.full
def test_clamps_shift_both_pins_by_at_most_the_stated_voltage(tmp_path: Path) -> None:
    """Reverse currents of 2 uA, compared with none, for an open sensor and without a signal."""
    design, deck = write_deck(tmp_path, [*VARIANT_CHANGES["article"]])
    limits = board_values(design).voltage_limits
    sensor = deck[deck.index("RJ1 ") :].splitlines()[0].rsplit(" ", 1)[0]
    (model,) = (line for line in deck.splitlines() if line.startswith(".model DBAT54"))
    deck = replace_elements(deck, RJ1=f"{sensor} 1e12")
    leaky, ideal = (
        run_ngspice(
            tmp_path,
            deck.replace(model, re.sub(r"Is=\S+", f"Is={current}", model)),
            "op\nwrdata out v(adc_envelope) v(adc_tactile)",
        )[0][1:]
        for current in ("2e-6", "1e-15")
    )
    shifts = [a - b for a, b in zip(leaky, ideal, strict=True)]
    stated = [2e-6 * ohm for ohm in (limits.output_pin_ohm, limits.tactile_pin_ohm)]
    assert all(abs(shift) < 1.001 * limit for shift, limit in zip(shifts, stated, strict=True))
    # E is at ground, where the lower diode of D2 does not block.
    assert shifts[0] > 0.5 * stated[0]
    assert abs(shifts[1]) < 0.03 * stated[1]


def limit_to_the_rails(deck: str) -> str:
    """Deck whose amplifiers' outputs end at the rails; their poles saturate there too."""
    limited = deck.replace("E1 out 0 pole 0 1\n", "B1 out 0 V=min(max(v(pole),0),v(vcc))\n")
    limited = limited.replace("E4 out 0 pole 0 1\n", "B4 out 0 V=min(max(v(pole),0),v(vcc))\n")
    limited = limited.replace("G1 0 pole p minus ", "B0 0 pole I=max(min(v(p,minus),1e-3),-1e-3)*")
    assert "B1 out" in limited
    return limited.replace("\n.subckt", "\n.global vcc\n.subckt", 1)


def test_an_adc_range_below_the_boards_signals_is_reported() -> None:
    """The rules refuse such a range, so it is put in here."""
    (warning,) = adc_range_warnings(replace(board_values(ARTICLE).voltage_limits, adc_range_v=3.3))
    assert "up to 4.41 V, is clipped" in warning
    assert "clips the top 1.11 V" in warning
    assert "detector.adc_range_v to at least 4.41" in warning


AMPLIFIER_OUTPUTS = {
    "U1a": "stage1_out",
    "U1b": "filtered",
    "U2": "tactile",
    "U2a": "tactile",
    "U3a": "rect_out",
    "U3b": "envelope",
}


def measure_output(deck: str, amplifier: str) -> str:
    """Deck with a source of 0 V, VM, in the output of an amplifier, which measures its current.

    The inverting input stays where it was, at the output or behind the feedback.
    """
    (line,) = (line for line in deck.splitlines() if line.startswith(f"X{amplifier} "))
    output = AMPLIFIER_OUTPUTS[amplifier]
    *words, model = line.split()
    assert words[-1] == output
    return deck.replace(line, f"{' '.join([*words[:-1], 'metered', model])}\nVM metered {output} 0")


@pytest.mark.full
@pytest.mark.parametrize("name", VARIANT_CHANGES)
def test_amplifier_loads_agree_with_the_currents_in_ngspice(tmp_path: Path, name: str) -> None:
    """A small signal around no bias, with 1 ohm in place of the
    diode D1, which then conducts all the time.
    """
    design, deck = write_deck(tmp_path, list(VARIANT_CHANGES[name]))
    values = board_values(design)
    bandwidth_hz = find_gain_bandwidth_hz(design.board)
    currents = compute_output_currents(board_circuit(values), bandwidth_hz, design.board.cutoff_hz)
    # The comparator's switch, which drives none of these outputs, keeps ngspice from finding the
    # operating point.
    deck = "\n".join(line for line in deck.splitlines() if not line.startswith("SU4 ")) + "\n"
    assert currents[0].output.amplifier == "U1a"
    diode = next((line for line in deck.splitlines() if line.startswith("D1 ")), None)
    blocked, conducting = (
        deck.replace(diode, f"RD1 {' '.join(diode.split()[1:3])} {ohm}") if diode else deck
        for ohm in ("1e12", "1")
    )
    filter_ohm = []
    for each in currents:
        amplifier = each.output.amplifier
        if amplifier not in AMPLIFIER_OUTPUTS:  # the buffer of VMID
            continue
        output = AMPLIFIER_OUTPUTS[amplifier]
        for variant, siemens in (
            (conducting, each.filter_s + each.diode_s),
            (blocked, each.filter_s),
        ):
            is_blocked = variant is blocked and diode is not None
            if not siemens.any() or (is_blocked and not name.startswith("article")):
                continue
            reference = "" if name == "article" else "-v(vmid)"
            commands = (
                f"ac lin 60 67 201\nlet u = v({output}){reference}\nlet z = abs(u/i(vm))\n"
                f"let a = abs(i(vm)/(v(tactile){reference}))\nwrdata out z a"
            )
            rows = run_ngspice(tmp_path, measure_output(variant, amplifier), commands)
            ohm = min(row[1] for row in rows)
            assert np.abs(each.gain / siemens).min() == pytest.approx(ohm, rel=0.02), amplifier
            if not is_blocked:
                assert np.abs(siemens).max() == pytest.approx(
                    max(row[-1] for row in rows), rel=0.02
                )
            if amplifier in ("U1a", "U1b") and (siemens == each.filter_s).all():
                filter_ohm.append(ohm)
    assert values.filter_load_ohm == pytest.approx(min(filter_ohm), rel=0.02)


@pytest.mark.full
@pytest.mark.parametrize("cutoff", ["40", "67", "150"])
@pytest.mark.parametrize("series", ["E12", "E24", "E96"])
def test_load_below_that_of_the_data_sheets_is_warned_of_with_a_remedy(
    series: str, cutoff: str
) -> None:
    changes = [
        f"board.series={series}",
        f"board.cutoff_hz={cutoff}",
        "board.envelope_capacitor_uf=1",
    ]
    changes.append("board.amplifier=OPA2197")  # others cannot drive the load at all

    def warnings(*more: str) -> list[str]:
        design = load_article([*changes, *more])
        values = board_values(design)
        return list(load_warnings(design, values.filter_load_ohm, values.preferred.c_f))

    (warning,) = warnings("board.capacitor_uf=4.7")
    assert "may clip earlier than stated; set, for example, board.capacitor_uf=" in warning
    assert "at most" not in warning  # resistors are rounded, so a larger capacitor may pass
    assert warnings(warning.split()[-1].rstrip(".")) == []
    # A selected capacitor may take R1 down to 2k, and the load a little below that.
    for capacitors in ("E6", "E12"):
        for warning in warnings(f"board.capacitor_series={capacitors}"):
            _, first, _, second = warning.rstrip(".").rsplit(" ", 3)
            assert warnings(first, second) == []


@pytest.mark.full
@pytest.mark.every_case
@pytest.mark.parametrize("name", VARIANT_CHANGES)
def test_total_noise_agrees_with_ngspice(tmp_path: Path, name: str) -> None:
    """All amplifiers and resistors, 0.1 Hz to 1 MHz: 20 mV after the
    article's filters, 0.1 mV on the other boards.
    """
    design, deck = write_deck(tmp_path, list(VARIANT_CHANGES[name]))
    rows, total = noise_budget(
        add_noise(board_circuit(board_values(design)), find_gain_bandwidth_hz(design.board))
    )
    assert rows[0].cause == ("U2" if name == "article" else "U2a")
    for net in ("TACTILE", "FILTERED", "ADC_TACTILE"):
        # The noise is measured against ground, as the ADC measures it. On boards for a controller
        # it contains VMID's.
        assert total[NETS.index(net)] == pytest.approx(
            read_noise_total(tmp_path, deck, net), rel=0.005
        ), net
    found = board_values(design).noise
    assert [found.tactile_v, found.tactile_pin_v] == pytest.approx([total[0], total[3]], rel=1e-3)
    pin = "FILTERED" if name == "article" else "ADC_FILTERED"
    assert found.filtered_pin_v == pytest.approx(read_noise_total(tmp_path, deck, pin), rel=0.005)
    assert found.filtered_v == pytest.approx(total[NETS.index("FILTERED")], rel=1e-3)
    figures = {"article": 20.1e-3, "precision": 0.132e-3, "comparator": 0.101e-3}
    assert found.filtered_v == pytest.approx(figures.get(name, found.filtered_v), rel=0.01)


@pytest.mark.parametrize(
    ("gain_resistor", "density_nv"), [("1M", 57.37), ("100k", 43.01), ("10k", 35.29)]
)
def test_output_noise_of_the_bridge_amplifier_shows_at_low_gain(
    gain_resistor: str, density_nv: float
) -> None:
    """AD623's data sheet: 35 nV at the input and 50 nV at the output;
    with gains of 1.1, 2 and 11 [nV/sqrt(Hz)].
    """
    circuit = board_circuit(board_values(ARTICLE)).replace("R14", gain_resistor)
    sources = {source.name: source for source in add_noise(circuit, 4e6).sources}
    assert sources["U2"].noise == pytest.approx(density_nv * 1e-9, rel=1e-3)
