"""Descriptions of the library for Arduino and PlatformIO."""

from __future__ import annotations

from fingertip import __version__
from fingertip.design import Design
from fingertip.foundation.files import encode_json

NAME = "FingertipSlip"
_SUMMARY = "Slip detector of a prosthetic fingertip."


def library_properties(design: Design) -> bytes:
    """Return the library's description for Arduino."""
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
    """Return the library's description for PlatformIO."""
    data = {
        "name": NAME,
        "version": _semantic_version(),
        "description": f"{_SUMMARY} {_describe(design)}",
        "keywords": ["slip", "tactile", "prosthetics"],
        "license": "Apache-2.0",
        "frameworks": "*",
        "platforms": "*",
        "headers": "slip_detector.h",
        "build": {"flags": ["-ffp-contract=off"]},
    }
    return encode_json(data)


def _describe(design: Design) -> str:
    rate = design.detector.sample_rate_hz
    bits = design.detector.adc_bits
    return (
        f"Made by fingertip for the design {design.name}: {rate:g} samples per second, "
        f"converter of {bits} bits."
    )


def _semantic_version() -> str:
    """Return the version without a suffix, which Arduino does not accept."""
    numbers = __version__.split("+")[0].split(".")[:3]
    digits = ("".join(filter(str.isdigit, number)) for number in numbers)
    return ".".join(number or "0" for number in digits)
