"""Beltspace: belt-drive designs by the billion, down to the exact Pareto front.

A study says which inputs are chosen, which loads the drive must survive and what nobody knows exactly. Every design is judged in its
worst case:

    import beltspace

    study = beltspace.Study.from_file("studies/metal-cvt.toml")
    result = study.sweep(progress=True)
    front = result.front.to_pandas()

Without a study a model is evaluated for many rows at once:

    found = beltspace.evaluate("metal-cvt", {"band_count": [6, 9, 12], "torque_Nm": 150})
    found["axial_force_N"]

Units stand in the names: `torque_Nm` is in N m, `band_thickness_mm` in mm. Absent values are NaN in numpy and null in Arrow.
"""

from beltspace._beltspace import Column, Model, Result, RowStream, Study, Table, __version__, evaluate, models
from beltspace._errors import BeltspaceError, Problem, RequestError, RunError, StudyError

__all__ = [
    "BeltspaceError",
    "Column",
    "Model",
    "Problem",
    "RequestError",
    "Result",
    "RowStream",
    "RunError",
    "Study",
    "StudyError",
    "Table",
    "__version__",
    "evaluate",
    "models",
]
