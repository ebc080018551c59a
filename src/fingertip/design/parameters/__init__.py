"""Parameters of a design. Each one is declared once: default, unit, bounds and description."""

from fingertip.design.parameters.bone import Bone, Hand, Strength
from fingertip.design.parameters.declaration import ParameterTable, choice, quantity, text
from fingertip.design.parameters.electronics import Board, Detector
from fingertip.design.parameters.finger import ChosenSilicone, CustomSensor, ForceCurve, Sensor, Skin
from fingertip.design.parameters.mold import Mold, Printer

__all__ = [
    "Board",
    "Bone",
    "ChosenSilicone",
    "CustomSensor",
    "Detector",
    "ForceCurve",
    "Hand",
    "Mold",
    "ParameterTable",
    "Printer",
    "Sensor",
    "Skin",
    "Strength",
    "choice",
    "quantity",
    "text",
]
