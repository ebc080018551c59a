"""Names of the nets that several blocks of the board share."""

GND = "GND"
VCC = "VCC"
VEE = "VEE"
VMID = "VMID"
"""Buffered mid-supply of a single supply: the signal ground of a board without a negative rail."""

SENSOR = "SENSOR"
BIAS = "BIAS"
"""Voltage at which a transimpedance stage holds the sensor."""
SUM = "SUM"
"""Input of a transimpedance stage, a virtual ground."""
REFERENCE = "REFERENCE"
TACTILE = "TACTILE"
FEEDBACK = "FEEDBACK"
STAGE1_OUT = "STAGE1_OUT"
STAGE2_MID = "STAGE2_MID"
STAGE2_IN = "STAGE2_IN"
FILTERED = "FILTERED"
ENVELOPE = "ENVELOPE"
RECT_OUT = "RECT_OUT"
MEAN = "MEAN"
THRESHOLD = "THRESHOLD"
SLIP = "SLIP"
SLIP_OUT = "SLIP_OUT"
"""`SLIP` behind R34, at the output connector."""
ADC_TACTILE = "ADC_TACTILE"
ADC_ENVELOPE = "ADC_ENVELOPE"
POWER_IN = "POWER_IN"
"""Supply at its connector, ahead of the protection against reversed polarity."""
ADC_FILTERED = "ADC_FILTERED"
VMID_OUT = "M_OUT"
"""`VMID` behind R24, at the output connector."""

RAILS = (GND, VCC, VEE)
"""Nets that power symbols name in a schematic."""

UNCONNECTED = "unconnected-("
"""Beginning of the name that KiCad gives the net of a pin that is left open on purpose."""


def kicad_net_name(net: str) -> str:
    """Name of a net in KiCad: with the path of its sheet, here "/",
    unless power symbols or global labels name it.
    """
    return net if net in (*RAILS, VMID) or net.startswith(UNCONNECTED) else f"/{net}"
