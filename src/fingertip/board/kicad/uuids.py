"""UUIDs derived from names instead of random ones, so that the same design gives the same bytes."""

from __future__ import annotations

import uuid

from fingertip.board.circuit import Circuit

# Any fixed UUID serves. It keeps this project's names apart from those of others.
_NAMESPACE = uuid.uuid5(uuid.NAMESPACE_OID, "fingertip.board")


def component_uuid(circuit: Circuit, reference: str) -> str:
    """UUID by which KiCad identifies a component. It depends on circuit and reference only, not on the value."""
    return named_uuid(circuit, reference)


def named_uuid(circuit: Circuit, name: str) -> str:
    """UUID of any other item in the circuit's files, from a name that is unique in the circuit."""
    return str(uuid.uuid5(_NAMESPACE, f"{circuit.name}/{name}"))
