"""Compare cutoff frequencies: component values of the filter board, and the delay until slip is
detected.

Run from a clone of the repository: .venv/bin/python examples/compare_cutoff_frequencies.py
"""

from fingertip import Design, Trial, board_values, detect, simulate

trial = Trial(surface="medium", speed_m_s=0.04, seed=1)

print("cutoff        R1        R2        R3      -3 dB     delay")
for cutoff_hz in (50, 67, 80, 100):
    design = Design.load("params/fsr400.toml", changes=[f"board.cutoff_hz={cutoff_hz}"])
    values = board_values(design)
    resistors = values.preferred
    score = detect(simulate(design, trial), design, "digital").score
    delay = f"{1000 * score.delays_s[0]:.1f} ms" if score and score.delays_s else "not found"
    print(
        f"{cutoff_hz:3} Hz   {resistors.r1_ohm:6.0f} ohm {resistors.r2_ohm:6.0f} ohm "
        f"{resistors.r3_ohm:6.0f} ohm"
        f"   {values.achieved_response.cutoff_hz:6.2f} Hz   {delay}"
    )
