"""Files that make the library one of Arduino and of PlatformIO."""

from __future__ import annotations

import json

from fingertip._version import __version__
from fingertip.design import Design

NAME = "FingertipSlip"
"""Name of the library."""
PROPERTIES, MANIFEST = "library.properties", "library.json"
_SUMMARY = "Slip detector of a prosthetic fingertip."
_LICENSE = "Apache-2.0"


def library_properties(design: Design) -> bytes:
    """Description of the library for Arduino."""
    fields = {
        "name": NAME,
        "version": _semantic_version(),
        "author": "The fingertip contributors",
        "maintainer": "The fingertip contributors",
        "sentence": _SUMMARY,
        "paragraph": _describe(design),
        "category": "Sensors",
        "url": "https://doi.org/10.1109/TMRB.2021.3060032",
        "architectures": "*",
        "includes": "slip_detector.h",
    }
    return "".join(f"{key}={value}\n" for key, value in fields.items()).encode()


def library_manifest(design: Design) -> bytes:
    """Description of the library for PlatformIO."""
    data = {
        "name": NAME,
        "version": _semantic_version(),
        "description": f"{_SUMMARY} {_describe(design)}",
        "keywords": ["slip", "tactile", "prosthetics"],
        "license": _LICENSE,
        "frameworks": "*",
        "platforms": "*",
        "headers": "slip_detector.h",
        "build": {"flags": ["-ffp-contract=off"]},
    }
    return (json.dumps(data, indent=2) + "\n").encode()


def _describe(design: Design) -> str:
    rate, bits = design.detector.sample_rate_hz, design.detector.adc_bits
    return f"Made by fingertip for the design {design.name}: {rate:g} samples per second, converter of {bits} bits."


def _semantic_version() -> str:
    """Version without a suffix that Arduino does not accept."""
    numbers = __version__.split("+")[0].split(".")[:3]
    return ".".join("".join(c for c in number if c.isdigit()) or "0" for number in numbers)
