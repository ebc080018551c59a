"""Coefficients of RODAS, as published.

E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, 2nd ed., 1996, section IV.10, and their code RODAS.
"""

GAMMA = 0.25
ALPHA = (0.0, 0.386, 0.21, 0.63, 1.0, 1.0)
"""Times of the stages, as fractions of the step."""
D = (0.25, -0.1043, 0.1035, -0.0362, 0.0, 0.0)
"""Coefficients of the time derivative."""
_LAST = (1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950)
A = (
    (1.544,),
    (0.9466785280815826, 0.2557011698983284),
    (3.314825187068521, 2.896124015972201, 0.9986419139977817),
    _LAST,
)
"""Coefficients a_ij of stages 2 to 5. Stage 6 has those of stage 5, and 1 for u_5."""
C = (
    (-5.6688,),
    (-2.430093356833875, -0.2063599157091915),
    (-0.1073529058151375, -9.594562251023355, -20.47028614809616),
    (7.496443313967647, -10.24680431464352, -33.99990352819905, 11.70890893206160),
    (8.083246795921522, -7.981132988064893, -31.52159432874371, 16.31930543123136, -6.058818238834054),
)
"""Coefficients c_ij of stages 2 to 6."""
