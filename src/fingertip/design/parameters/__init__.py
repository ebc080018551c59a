"""Parameters of a design. Each one is declared once: default, unit, bounds and description."""

from fingertip.design.parameters.declaration import ParameterTable, choice, quantity
from fingertip.design.parameters.design_tables import DesignTables
from fingertip.design.parameters.electronics import Board, Detector
from fingertip.design.parameters.finger import Bone, CustomSensor, Mold, Printer, Sensor, Skin, Strength

__all__ = [
    "Board",
    "Bone",
    "CustomSensor",
    "DesignTables",
    "Detector",
    "Mold",
    "ParameterTable",
    "Printer",
    "Sensor",
    "Skin",
    "Strength",
    "choice",
    "quantity",
]
