"""A user's program, for mypy only."""

from pathlib import Path
from typing import assert_type

import numpy as np

import beltspace

study = beltspace.Study.from_dict({"model": "metal-cvt", "design": {"band_count": [6, 7]}})
result = study.sweep(progress=lambda what, done, total: print(what, done, total), threads=2, engine="cpu")
assert_type(result.front, beltspace.Table)
assert_type(result.top, beltspace.Table | None)
force: np.ndarray[tuple[int, ...], np.dtype[np.float64]] = result.front["axial_force_N"]
found = beltspace.evaluate("metal-cvt", {"band_count": np.arange(6, 9), "torque_Nm": 150.0, "traction": "limit"}, outputs=["axial_force_N"])
again = study.worst(found)
brake = beltspace.Model("brake", {"torque_Nm": "force_N * radius_mm"}, inputs={"force_N": {"default": 1.0}}, outputs=["torque_Nm"])
winch = beltspace.Model("winch", formulas={"torque_Nm": "force_N * radius_mm"}, inputs={"force_N": {"default": 1.0}})
of_file = beltspace.Model(Path("drive.toml"))
try:
    beltspace.Study.from_file("study.toml")
except beltspace.StudyError as error:
    line: int = error.problems[0].line
