"""Laboratory: a design's detector on simulated slips, on minutes without slip, and in studies of the article."""

from fingertip.lab.campaign.plan import CampaignPlan
from fingertip.lab.campaign.run import CampaignResult, run_campaign
from fingertip.lab.validation import FILES, Validation, validate

__all__ = ["FILES", "CampaignPlan", "CampaignResult", "Validation", "run_campaign", "validate"]
