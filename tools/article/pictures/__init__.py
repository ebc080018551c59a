"""Figures of the article, drawn from simulated trials: each with
what the article says beside what is found here.
"""
