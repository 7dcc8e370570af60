# ---
# jupyter:
#   jupytext:
#     text_representation:
#       format_name: percent
# ---

# %% [markdown]
# # From a study to a plot
# A push belt for 150 N m at every ratio: sweep it, look at the front, filter it, and see how it moves with the torque.

# %%
from pathlib import Path

import beltspace

root = next(it for it in [Path.cwd(), *Path.cwd().parents] if (it / "studies").is_dir())
study = beltspace.Study.from_file(root / "studies" / "metal-cvt.toml")
study

# %% [markdown]
# `check` tells what a sweep will take, and what is odd about the study.

# %%
study.check()

# %%
result = study.sweep(progress=True)
result

# %% [markdown]
# The front as a pandas table: light belts with some reserve of stress.

# %%
front = result.front.to_pandas()
light = front[(front["band_count"] <= 11) & (front["stress_margin"] >= 0.08)]
light.sort_values("axial_force_upper_N").head()[["band_count", "band_thickness_mm", "axial_force_upper_N", "stress_margin"]]

# %%
import matplotlib.pyplot as plt

figure, axes = plt.subplots(figsize=(6, 4))
points = axes.scatter(front["axial_force_upper_N"] / 1e3, front["stress_margin"], c=front["band_count"], s=6)
figure.colorbar(points, label="bands")
axes.set(xlabel="axial force, upper bound (kN)", ylabel="stress margin")
figure

# %% [markdown]
# The same study at other torques, in a loop: least force and number of feasible designs.

# %%
moved = {}
for torque in (90, 110, 130, 150):
    other = study.with_values(torque_Nm=torque).sweep()
    moved[torque] = (other.feasible_designs, float(other.front["axial_force_upper_N"].min()))
moved

# %% [markdown]
# A million drives in one call, and their share beyond 30 kN.

# %%
import numpy as np

random = np.random.default_rng(1)
drives = {"friction": random.normal(0.08, 0.004, 1_000_000), "ratio": random.uniform(0.5, 2, 1_000_000), "torque_Nm": 120}
found = beltspace.evaluate("metal-cvt", drives, outputs=["axial_force_N"])
beyond = float(np.nanmean(found["axial_force_N"] > 30e3))
beyond
