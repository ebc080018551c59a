"""A design tried on simulated slips and on minutes without any, before it is printed."""

from fingertip.campaign.plan import Amount
from fingertip.campaign.study import Study, run

__all__ = ["Amount", "Study", "run"]
