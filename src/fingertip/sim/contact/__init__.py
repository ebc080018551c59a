"""Contact between skin and surface: friction, pad, surface profile, vibration, and the integrators
for them.

Loads [N] and motion of the carriage [m] come in; position and velocity of the pad and its friction
go out.

>>> from fingertip.sim.contact.friction import Friction
>>> Friction(mu_s=0.6, mu_c=0.48).is_passive
True
"""
