"""Which inputs decide the axial force of a push belt: Sobol indices by SALib on `beltspace.evaluate`. Needs SALib."""

import numpy as np
from SALib.analyze import sobol as analysis
from SALib.sample import sobol

import beltspace

PROBLEM = {
    "num_vars": 4,
    "names": ["friction", "groove_angle_deg", "ratio", "torque_Nm"],
    "bounds": [[0.07, 0.09], [20, 24], [0.5, 2.0], [100, 150]],
}

rows = sobol.sample(PROBLEM, 4096, calc_second_order=False, seed=1)
found = beltspace.evaluate("metal-cvt", dict(zip(PROBLEM["names"], rows.T, strict=True)), outputs=["axial_force_N"])
force = found["axial_force_N"]
assert np.isfinite(force).all()
indices = analysis.analyze(PROBLEM, force, calc_second_order=False, seed=1)
for name, first, total in zip(PROBLEM["names"], indices["S1"], indices["ST"], strict=True):
    print(f"{name}: first order {first:.3f}, total {total:.3f}")
