"""What two optimisers miss of an exact front: NSGA-II of pymoo and Optuna's sampler beside a sweep of the same study.

Usage: optimisers.py [FIGURE.png] [--short]. Needs pymoo, optuna and matplotlib.
"""

import sys
from pathlib import Path

import numpy as np

import beltspace

STUDY = {
    "model": "metal-cvt",
    "title": "A push belt for 100 N m",
    "design": {
        "groove_angle_deg": {"from": 18, "to": 30, "count": 61},
        "band_thickness_mm": {"from": 0.1, "to": 0.3, "step": 0.005},
        "band_count": {"from": 6, "to": 14},
        "traction": {"from": 0.3, "to": 0.5, "count": 11},
    },
    "operation": {"ratio": {"from": 0.5, "to": 2.0, "count": 7, "spacing": "log"}, "torque_Nm": [50, 100]},
    "constraints": {"slip_margin": {"min": 0}, "stress_margin": {"min": 0}},
    "objectives": {"axial_force_upper_N": "min", "slip_margin": "max"},
}


def with_pymoo(study: beltspace.Study, evaluations: int) -> np.ndarray:
    """The front that NSGA-II finds: force in N and margin against slip. Each generation is one call."""
    from pymoo.algorithms.moo.nsga2 import NSGA2
    from pymoo.core.problem import Problem
    from pymoo.optimize import minimize

    class Belt(Problem):  # type: ignore[misc]
        def __init__(self) -> None:
            super().__init__(n_var=4, n_obj=2, n_ieq_constr=2, xl=[18, 0.1, 6, 0.3], xu=[30, 0.3, 14, 0.5])

        def _evaluate(self, x: np.ndarray, out: dict[str, np.ndarray], *_: object, **__: object) -> None:
            rows = dict(zip(study.design, x.T, strict=True))
            found = study.worst(rows | {"band_count": np.round(rows["band_count"])})
            # Where a value has no meaning the design is far from feasible.
            force, slip = np.nan_to_num(found["axial_force_upper_N"], nan=1e9), np.nan_to_num(found["slip_margin"], nan=-10)
            stress = np.nan_to_num(found["stress_margin_margin"], nan=-10)
            out["F"] = np.column_stack([force, -slip])
            out["G"] = np.column_stack([-slip, -stress])

    found = minimize(Belt(), NSGA2(pop_size=100), ("n_eval", evaluations), seed=1)
    return np.column_stack([found.F[:, 0], -found.F[:, 1]])


def with_optuna(study: beltspace.Study, evaluations: int) -> np.ndarray:
    """The front that Optuna finds, one design at a time."""
    import optuna

    optuna.logging.set_verbosity(optuna.logging.WARNING)

    def objective(trial: optuna.Trial) -> tuple[float, float]:
        rows = {
            "groove_angle_deg": trial.suggest_float("groove_angle_deg", 18, 30),
            "band_thickness_mm": trial.suggest_float("band_thickness_mm", 0.1, 0.3),
            "band_count": trial.suggest_int("band_count", 6, 14),
            "traction": trial.suggest_float("traction", 0.3, 0.5),
        }
        row = study.worst(rows).row(0)
        if row["feasible"] != "yes":
            raise optuna.TrialPruned
        return float(row["axial_force_upper_N"]), float(row["slip_margin"])  # type: ignore[arg-type]

    search = optuna.create_study(directions=["minimize", "maximize"], sampler=optuna.samplers.NSGAIISampler(seed=1))
    search.optimize(objective, n_trials=evaluations)
    return np.array([trial.values for trial in search.best_trials])


def area(points: np.ndarray, corner: tuple[float, float]) -> float:
    """The area in N that points dominate up to a corner: the larger, the better the front."""
    total, best = 0.0, corner[1]
    for force, margin in sorted(map(tuple, points)):
        if force < corner[0] and margin > best:
            total += (corner[0] - force) * (margin - best)
            best = margin
    return total


def main() -> None:
    words = sys.argv[1:]
    short = "--short" in words
    figure = next((Path(it) for it in words if not it.startswith("-")), None)
    study = beltspace.Study.from_dict(STUDY)
    result = study.sweep()
    exact = np.column_stack([result.front["axial_force_upper_N"], result.front["slip_margin"]])
    corner = (float(exact[:, 0].max()), 0.0)
    fronts = {"exact, by sweep": exact, "pymoo, NSGA-II": with_pymoo(study, 500 if short else 5000)}
    fronts["Optuna, NSGA-II"] = with_optuna(study, 100 if short else 2000)
    print(f"{study.designs} designs in {study.scenarios} scenarios each, swept in {result.seconds:.2f} s")
    for name, points in fronts.items():
        print(f"{name}: {len(points)} designs, {area(points, corner) / area(exact, corner):.1%} of the exact front's area")
    if figure:
        import matplotlib

        matplotlib.use("agg")
        import matplotlib.pyplot as plt

        drawing, axes = plt.subplots(figsize=(7, 4.5))
        for (name, points), size in zip(fronts.items(), (5, 14, 14), strict=True):
            axes.scatter(points[:, 0] / 1e3, points[:, 1], s=size, label=name)
        axes.set(xlabel="axial force (kN), to be small", ylabel="margin against slip, to be large")
        axes.legend()
        drawing.savefig(figure, dpi=120, bbox_inches="tight")


main()
