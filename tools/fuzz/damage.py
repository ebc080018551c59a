"""Damage to valid files: bits, slices, numbers and lines."""

from __future__ import annotations

import re

from hypothesis import strategies as st

from tools.fuzz.values import ODD_NUMBERS, ODD_VALUES

_NUMBER = re.compile(rb"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?", re.IGNORECASE)
_MARKS = ("\0", "\x1b[2J", "\ufeff", "\r", "\n", ",", ";", "\t", '"', "#", "é")
_TOKENS = (
    *(text.encode("utf-8", "replace") for text in (*ODD_NUMBERS, *ODD_VALUES, *_MARKS)),
    *(b"\xff", b"\xfe\xff", b"\xff\xfe", bytes(64), b"A" * 3000),
)
_HEADER_BYTES = 400
"""Length of the beginning and the end of a file that headers and directories take [bytes]."""


@st.composite
def damaged(draw: st.DrawFn, valid: bytes, most: int = 4) -> bytes:
    """Damage a valid file in one place or some."""
    data = bytearray(valid)
    for _ in range(draw(st.integers(1, most))):
        if not data:
            break

        kind = draw(st.integers(0, 9))
        # Headers stand at the beginning, and the directory of an archive at the end.
        part = draw(st.sampled_from(("any", "begin", "end")))
        low = max(0, len(data) - _HEADER_BYTES) if part == "end" else 0
        high = min(len(data), _HEADER_BYTES) if part == "begin" else len(data)
        at = draw(st.integers(low, max(low, high - 1)))
        length = draw(st.sampled_from((1, 2, 4, 8, 30, 300)))

        if kind == 0:
            data[at] ^= 1 << draw(st.integers(0, 7))
        elif kind == 1:
            del data[at : at + length]
        elif kind == 2:
            data[at:at] = data[at : at + length] * draw(st.sampled_from((1, 2, 50)))
        elif kind == 3:
            del data[at:]
        elif kind == 4:
            data[at:at] = draw(st.sampled_from(_TOKENS))
        elif kind in (5, 6):
            found = list(_NUMBER.finditer(data, low, high))[:2000]
            if found:
                match = draw(st.sampled_from(found))
                data[match.start() : match.end()] = draw(st.sampled_from(_TOKENS))
        elif kind == 7:
            size = draw(st.sampled_from((1, 2, 4, 8)))
            number = draw(
                st.sampled_from((0, 1, 2 ** (8 * size) - 1, 2 ** (8 * size - 1), 2 ** (4 * size)))
            )
            data[at : at + size] = number.to_bytes(size, draw(st.sampled_from(("little", "big"))))
        elif kind == 8:
            lines = bytes(data).split(b"\n")[:5000]
            one, other = (draw(st.integers(0, len(lines) - 1)) for _ in range(2))
            lines[one], lines[other] = lines[other], lines[one]
            data = bytearray(b"\n".join(lines))
        else:
            data[at : at + length] = draw(st.binary(min_size=length, max_size=length))

    return bytes(data)


@st.composite
def nudged(draw: st.DrawFn, valid: bytes) -> bytes:
    """Change one number of a valid text within its unit: near its value, or to one of
    the others.
    """
    found = list(_NUMBER.finditer(valid))
    match = draw(st.sampled_from(found))
    factor = draw(
        st.one_of(st.floats(0.97, 1.03), st.floats(0.5, 2.0), st.sampled_from((0.0, -1.0, 10.0)))
    )
    number = draw(
        st.sampled_from((b"%.6g" % (factor * float(match[0])), draw(st.sampled_from(found))[0]))
    )

    return valid[: match.start()] + number + valid[match.end() :]
