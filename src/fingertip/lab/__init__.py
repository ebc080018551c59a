"""Laboratory: a design's detector on simulated slips and on minutes without slip, in a hand, and
how accurate that is.

A design and the size of a campaign come in; requirements, tables and plots go out (`fingertip
validate`, `accuracy`).

>>> from fingertip.lab.campaign.campaign import CampaignPlan, generate_cases
>>> cases = generate_cases(CampaignPlan(trials=8, negative_minutes=0.5))
>>> len([case for case in cases if case.cause == "slip"])
8
"""
