"""The studies of the benches, finer: by how many levels their axes have."""
import re
from pathlib import Path

GRID = Path("studies/metal-grid.toml").read_text()
CVT = Path("benches/studies/metal-cvt-traction.toml").read_text()


def grid(levels):
    """metal-grid with so many levels on its four continuous axes: 11 levels^4 designs."""
    return GRID.replace("count = 37", f"count = {levels}")


def cvt(resolutions, angle, thickness, traction):
    """The study benches/studies/metal-cvt-traction.toml, finer, without its histogram and its map; without resolutions the front of four objectives
    would be as large as the grid."""
    force, stress, slip = resolutions
    text, changes = CVT, (
        ("count = 61 }", f"count = {angle} }}"),
        ("step = 0.005 }", f"count = {thickness} }}"),
        ("count = 11 }", f"count = {traction} }}"),
        ('axial_force_N = "min"', f'axial_force_N = {{ goal = "min", resolution = {force} }}'),
        ('stress_margin = "max"', f'stress_margin = {{ goal = "max", resolution = {stress} }}'),
        ('slip_margin   = "max"', f'slip_margin   = {{ goal = "max", resolution = {slip} }}'),
    )
    for old, new in changes:
        if text.count(old) != 1:
            raise SystemExit(f"benches/studies/metal-cvt-traction.toml has changed: {old} stands in it {text.count(old)} times")
        text = text.replace(old, new)
    return re.sub(r"(?m)^(histograms|maps) .*\n", "", text)
