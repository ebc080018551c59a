"""Identifiers made from stable names, so that files hold no random ones: the same design gives the same bytes."""

from __future__ import annotations

import uuid

from fingertip.board.circuit import Circuit

# Any fixed identifier does; it keeps this project's references apart from others'.
_NAMESPACE = uuid.uuid5(uuid.NAMESPACE_OID, "fingertip.board")


def part_uuid(circuit: Circuit, reference: str) -> str:
    """The identifier KiCad knows a part by, from circuit and reference alone: new values keep it."""
    return named_uuid(circuit, reference)


def named_uuid(circuit: Circuit, name: str) -> str:
    """An identifier of anything else in the circuit's files, from a name given once."""
    return str(uuid.uuid5(_NAMESPACE, f"{circuit.name}/{name}"))
