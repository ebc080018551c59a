"""Parameters of a design: all tables of a design file.

Each parameter is declared once, with its own bounds.

In: the tables of a file. Out: frozen tables; the rules between parameters are checked later.

>>> from fingertip.design.parameters import Tables
>>> Tables(skin={"width_mm": 18.0}).value("skin.width_mm")
18.0
"""

from __future__ import annotations

from collections.abc import Mapping
from hashlib import sha256
from pathlib import Path
from typing import Any, Literal, Self

from pydantic import ConfigDict, Field
from pydantic.fields import FieldInfo

from fingertip.catalogues.materials import load_silicones
from fingertip.design.parameters.board_and_detector import Board, Detector
from fingertip.design.parameters.bone_and_mold import Bone, Hand, Mold, Printer, Strength
from fingertip.design.parameters.declaration import (
    OWN,
    Above,
    Frozen,
    ParameterTable,
    choice,
    find_follows,
    quantity,
    suggest_name,
    text,
)
from fingertip.design.parameters.sensor_and_skin import (
    ChosenSilicone,
    CustomSensor,
    ForceCurve,
    Sensor,
    Skin,
)
from fingertip.foundation.errors import DesignError, Issue

__all__ = [
    "ELECTRONIC_TABLES",
    "PARAMETERS",
    "Above",
    "ParameterTable",
    "Tables",
    "choice",
    "quantity",
    "text",
]

ELECTRONIC_TABLES = frozenset({"force_curve", "board", "detector"})
"""Tables of the electronics, on which no part's shape depends."""
_MEASURED = frozenset({"sensor", "custom_sensor", "hand", "printer", "force_curve"})
"""Tables of what is measured, or read in a data sheet."""


class Tables(Frozen):
    """Contents of a design file."""

    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        strict=True,
        title="fingertip design",
    )

    name: str = Field(
        "fsr400",
        pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]{0,39}$",
        description="Name of the output folder.",
    )
    sensor: Sensor = Sensor()
    custom_sensor: CustomSensor = CustomSensor()
    bone: Bone = Bone()
    hand: Hand = Hand()
    skin: Skin = Skin()
    silicone: ChosenSilicone = ChosenSilicone()
    mold: Mold = Mold()
    printer: Printer = Printer()
    strength: Strength = Strength()
    force_curve: ForceCurve = ForceCurve()
    board: Board = Board()
    detector: Detector = Detector()

    def value(self, path: str) -> Any:
        """Return the value of a parameter by its dotted name, such as "skin.width_mm"."""
        table, _, key = path.rpartition(".")
        return getattr(getattr(self, table), key) if table else getattr(self, key)

    def with_values(self, values: Mapping[str, Any]) -> Self:
        """Copy the tables with other values such as {"skin.width_mm": 18.0}, unchecked."""
        update: dict[str, Any] = {}
        for path, value in values.items():
            name, _, key = path.rpartition(".")
            if name:
                table = update.get(name, getattr(self, name))
                update[name] = table.model_copy(update={key: value})
            else:
                update[key] = value

        return self.model_copy(update=update)

    def identity(self) -> dict[str, Any]:
        """Return all parameters, for the hash in a manifest.

        The hash of the adapter's file stands for its path.
        """
        data = self.with_bare_names().model_dump(mode="json")
        if self.bone.interface == "file":
            from fingertip.foundation.body_file import read_body  # starts processes  # noqa: PLC0415

            body = read_body(Path(self.bone.adapter_file))
            data["bone"]["adapter_file"] = sha256(body.data).hexdigest()

        return data

    def with_bare_names(self) -> Self:
        """Copy the tables with the bare name of the adapter's file, as a design file names it."""
        name = Path(self.bone.adapter_file).name
        if name == self.bone.adapter_file:
            return self

        return self.with_values({"bone.adapter_file": name})

    def with_silicone(self, name: str | None) -> Self:
        """Copy the tables with another silicone; the tables themselves if no name is given.

        Raises DesignError.
        """
        if name is None or name == self.silicone.product:
            return self

        known = (*load_silicones(), OWN)
        if name not in known:
            raise DesignError(
                Issue("--material", f"there is no {name!r}; {suggest_name(name, known)}")
            )

        return self.with_values({"silicone.product": name})


def _list_declarations() -> dict[str, FieldInfo]:
    declarations = {"name": Tables.model_fields["name"]}
    for name, info in Tables.model_fields.items():
        if isinstance(info.default, ParameterTable):
            fields = type(info.default).model_fields
            declarations |= {f"{name}.{key}": field for key, field in fields.items()}

    return declarations


PARAMETERS: Mapping[str, FieldInfo] = _list_declarations()
"""Declaration of every parameter by its dotted name, in the order of a design file."""


def find_kind(path: str) -> Literal["wish", "measurement", "derived"]:
    """Return whether a parameter is a wish, a measurement, or derived from these."""
    if find_follows(PARAMETERS[path]):
        return "derived"

    is_measured = path.partition(".")[0] in _MEASURED and path != "sensor.model"
    return "measurement" if is_measured else "wish"
