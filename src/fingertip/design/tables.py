"""All tables of a design file together, each parameter within its bounds; the rules between them are not asked yet."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, Field

from fingertip.design import sections


class Tables(BaseModel):
    """What a design file holds."""

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
