"""Validation campaigns: a design tried on simulated slips, and on minutes without slip, before it is printed."""

from fingertip.campaign.plan import CampaignPlan
from fingertip.campaign.run import CampaignResult, run_campaign
from fingertip.campaign.validation import Validation, validate

__all__ = ["CampaignPlan", "CampaignResult", "Validation", "run_campaign", "validate"]
