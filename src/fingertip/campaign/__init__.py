"""Validation campaigns: a design tried on simulated slips, and on minutes without slip, before it is printed."""

from fingertip.campaign.plan import CampaignPlan
from fingertip.campaign.run import CampaignResult, run_campaign

__all__ = ["CampaignPlan", "CampaignResult", "run_campaign"]
