"""Tour of fingertip in Jupyter: a design, its parts, a simulated slip and what a detector makes of
it.

Editors open this file as a notebook; the site of the documentation shows it with its outputs.
Run from a clone of the repository: .venv/bin/python examples/tour_in_jupyter.py
"""

# %% [markdown]
# The same cells [as a notebook to download](tour_in_jupyter.ipynb).

# %% [markdown]
# ## A design
#
# A bundled design, with a wider skin. Only what differs from the default design is shown.

# %%
import fingertip

design = fingertip.Design.load("fsr400", changes=["skin.width_mm=18", "name=wider"])
design

# %%
fingertip.picture(design, 1200)

# %% [markdown]
# A design that cannot be made is refused, with a value that passes.

# %%
try:
    fingertip.Design.load("fsr400", changes=["skin.width_mm=15"])
except fingertip.FingertipError as error:
    print(error)

# %% [markdown]
# ## Its parts
#
# `build` writes files and checks them. `fingertip.assembly(design)` gives them as a cadquery
# assembly.

# %%
built = fingertip.build(
    design, "out/wider", parts=["bone", "skin"], formats=["stl"], tolerance_mm=0.02
)
built

# %% [markdown]
# ## A simulated slip
#
# The pad slides over wood at 0.04 m/s. The true slip is known, because the trial is simulated.

# %%
trace = fingertip.simulate(design, fingertip.Trial(surface="wood", speed_m_s=0.04, seed=3))
trace

# %% [markdown]
# ## Detection

# %%
found = fingertip.detect(trace, design, "fast")
found

# %%
fingertip.plot_detection(found, "Slip over wood, simulated")

# %% [markdown]
# ## The board
#
# Component values, response and voltages of the design's board, from the same parameters.

# %%
values = fingertip.board_values(design)
print(f"R1 {values.preferred.r1_ohm:g} ohm, -3 dB at {values.achieved_response.cutoff_hz:.2f} Hz")
