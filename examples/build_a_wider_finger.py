"""Build a wider fingertip, read its checks, and weigh its silicone.

Run from a clone of the repository: .venv/bin/python examples/build_a_wider_finger.py
"""

from fingertip import Design, build

design = Design.load("params/fsr400.toml", changes=["skin.width_mm=18", "name=wider"])
result = build(design, formats=["stl"])

for part in result.parts:
    print(
        f"{part.part.name:12} {part.mesh.volume() / 1000:6.2f} cm3   "
        f"{result.folder / part.files['stl']}"
    )

failed = [check for check in result.checks if not check.passed]
print(f"{len(result.checks) - len(failed)} of {len(result.checks)} checks passed")

if failed:
    raise SystemExit(1)
