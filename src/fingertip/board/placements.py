"""The boards: 40 x 25 mm, all parts in front; sensor and supply enter left, signals leave right."""

from __future__ import annotations

from fingertip.board.placement import Placement, Spot

PAPER_PLACEMENT = Placement(
    40.0,
    25.0,
    {
        # Connectors and holes.
        "J1": Spot(2.2, 6.8), "J2": Spot(2.2, 13.0), "J3": Spot(37.2, 8.7),
        "H1": Spot(2.5, 2.5), "H2": Spot(37.5, 2.5), "H3": Spot(2.5, 22.5), "H4": Spot(37.5, 22.5),
        # Bridge and its amplifier.
        "R10": Spot(7.0, 3.0), "C7": Spot(6.6, 6.4), "R11": Spot(6.6, 8.2), "R12": Spot(10.4, 3.0),
        "R13": Spot(10.0, 4.8), "R14": Spot(15.4, 3.0), "U2": Spot(15.4, 6.0), "C13": Spot(10.4, 7.9),
        "C12": Spot(20.6, 4.4),
        # Supply.
        "C10": Spot(6.6, 12.4), "C11": Spot(6.6, 18.6),
        # First stage.
        "C1": Spot(11.4, 18.6), "R1": Spot(11.2, 16.4), "R4": Spot(11.2, 14.6), "R5": Spot(11.2, 12.8),
        "U1": Spot(17.6, 15.0), "C5": Spot(20.4, 11.0), "C6": Spot(16.2, 19.4),
        # Second stage.
        "C2": Spot(25.2, 11.4), "R2": Spot(25.0, 13.9), "C3": Spot(25.2, 16.4, 180), "R3": Spot(24.2, 19.5),
        # Peak detector.
        "D1": Spot(30.8, 13.9, 180), "R6": Spot(29.6, 17.0), "C4": Spot(28.6, 19.8),
        # To the converter.
        "R7": Spot(33.9, 11.4), "C8": Spot(33.9, 16.4), "D2": Spot(33.0, 21.6), "R8": Spot(26.0, 4.4),
        "C9": Spot(29.4, 4.4), "D3": Spot(33.0, 5.0),
        # Test points.
        "TP1": Spot(20.4, 7.4), "TP2": Spot(15.4, 10.4), "TP3": Spot(30.4, 10.8), "TP4": Spot(25.4, 22.2),
        "TP5": Spot(21.0, 22.2),
    },
    (
        ("FSR", 5.3, 10.0), ("+", 4.5, 13.0), ("0", 4.5, 15.54), ("-", 4.5, 18.08),
        ("T", 39.4, 8.7), ("E", 39.4, 11.24), ("0", 39.4, 13.78), ("0", 39.4, 16.32),
        ("fingertip slip filter", 13.0, 23.6),
    ),
)  # fmt: skip

PRECISION_PLACEMENT = Placement(
    40.0,
    25.0,
    {
        **PAPER_PLACEMENT.spots,
        # First stage's capacitor.
        "C14": Spot(7.2, 15.6),
        # Rectifier left of U3, envelope right of it.
        "U3": Spot(20.6, 21.9), "C6": Spot(15.2, 19.3), "R3": Spot(24.2, 18.35), "D1": Spot(7.6, 21.3),
        "D4": Spot(7.6, 23.7), "R15": Spot(12.0, 21.2), "R16": Spot(12.0, 23.0), "C16": Spot(15.2, 23.6),
        "R17": Spot(29.4, 16.6), "R6": Spot(29.0, 18.6), "C4": Spot(28.5, 21.0), "C15": Spot(26.6, 23.6),
        "TP3": Spot(30.4, 10.8), "TP4": Spot(31.6, 13.6), "TP5": Spot(23.6, 8.6),
    },
    (*PAPER_PLACEMENT.words[:-1], ("precision", 27.6, 7.2)),
)  # fmt: skip
"""The board of variant `precision`, with U3 and its parts along the lower edge."""

COMPARATOR_PLACEMENT = Placement(
    40.0,
    25.0,
    {
        **PRECISION_PLACEMENT.spots,
        "RV1": Spot(24.0, 7.6), "U4": Spot(29.0, 7.4), "R18": Spot(29.0, 10.3), "C17": Spot(29.0, 12.0),
        "R19": Spot(18.6, 9.0), "R20": Spot(22.4, 2.6), "R21": Spot(33.8, 8.2), "C18": Spot(33.8, 9.8),
        "TP1": Spot(20.0, 6.6), "TP3": Spot(28.6, 13.9), "TP4": Spot(31.4, 14.2), "TP5": Spot(12.6, 10.2),
        "TP2": Spot(15.4, 10.4), "R7": Spot(33.8, 12.2), "C8": Spot(33.8, 16.4),
    },
    (*PRECISION_PLACEMENT.words[:-2], ("S", 39.4, 16.32), ("comparator", 29.4, 1.4)),
)  # fmt: skip
"""The board of variant `comparator`, with U4 and the trimmer where `precision` is empty."""
