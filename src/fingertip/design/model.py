"""A design: all parameters of one fingertip, its board and its detector, validated as a whole and frozen."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from fingertip.design import sections
from fingertip.design.dimensions import Dimensions, derive
from fingertip.design.faults import from_pydantic
from fingertip.design.fields import Section
from fingertip.design.rules import broken
from fingertip.errors import DesignError, Fault


class Design(BaseModel):
    """One fingertip. Constructing it checks every bound and every rule, and raises all faults at once.

    Raises
    ------
    DesignError
        With one sentence for each parameter out of bounds, unknown name or broken rule.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, title="fingertip design")

    name: str = Field("fsr400", pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]{0,39}$", description="Name of the output folder.")
    sensor: sections.Sensor = sections.Sensor()
    custom_sensor: sections.CustomSensor = sections.CustomSensor()
    bone: sections.Bone = sections.Bone()
    skin: sections.Skin = sections.Skin()
    mold: sections.Mold = sections.Mold()
    printer: sections.Printer = sections.Printer()
    board: sections.Board = sections.Board()
    detector: sections.Detector = sections.Detector()

    def __init__(self, **tables: Any) -> None:
        try:
            super().__init__(**tables)
        except ValidationError as error:
            faults = from_pydantic(error, type(self))
            raise DesignError([*faults, *_rules_beside(tables, faults)]) from None
        if faults := [fault for fault, _ in broken(self)]:
            raise DesignError(faults)

    @classmethod
    def load(cls, *files: str | Path, changes: Iterable[str] = ()) -> Design:
        """Read a design: defaults, then each file, then changes such as ``"mold.draft_deg=2"``, the later winning.

        Raises
        ------
        DesignError
            If a file is missing or no valid TOML, or the design it gives is refused.
        """
        from fingertip.design.cascade import gather

        return cls(**gather(files, changes))

    @cached_property
    def dimensions(self) -> Dimensions:
        """Lengths that follow from the parameters."""
        return derive(self)


def _rules_beside(tables: Mapping[str, Any], faults: Iterable[Fault]) -> list[Fault]:
    """Broken rules among the parameters that are in bounds, so that one run tells everything that is wrong."""
    faulty = {fault.field for fault in faults}
    fields: dict[str, Any] = {}
    for name, info in Design.model_fields.items():
        table, default = tables.get(name), info.default
        if isinstance(default, Section):
            given = table if isinstance(table, Mapping) else {}
            known = type(default).model_fields
            kept = {k: v for k, v in given.items() if k in known and f"{name}.{k}" not in faulty}
            fields[name] = default.model_copy(update=kept)
        else:
            fields[name] = default
    return [fault for fault, reads in broken(Design.model_construct(**fields)) if not reads & faulty]
