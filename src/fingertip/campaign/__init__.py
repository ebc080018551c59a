"""Validation campaigns: a design tried on simulated slips, and on minutes without slip, before it is printed."""

from fingertip.campaign.plan import CampaignPlan
from fingertip.campaign.run import CampaignResult, run_campaign
from fingertip.campaign.validation import FILES, Validation, validate

__all__ = ["FILES", "CampaignPlan", "CampaignResult", "Validation", "run_campaign", "validate"]
