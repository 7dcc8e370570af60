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
        "groove_angle_deg": {"from": 18, "to": 30, "count": 121},
        "band_thickness_mm": {"from": 0.1, "to": 0.3, "step": 0.005},
        "band_count": {"from": 6, "to": 14},
        "traction": {"from": 0.3, "to": 0.5, "count": 81},
    },
    "operation": {"ratio": {"from": 0.5, "to": 2.0, "count": 7, "spacing": "log"}, "torque_Nm": [50, 100]},
    "constraints": {"slip_margin": {"min": 0}, "stress_margin": {"min": 0}},
    "objectives": {"axial_force_upper_N": "min", "slip_margin": "max"},
}

# The levels of each axis: all three choose among the same designs.
LEVELS = {
    "groove_angle_deg": np.linspace(18, 30, 121),
    "band_thickness_mm": np.linspace(0.1, 0.3, 41),
    "band_count": np.arange(6, 15),
    "traction": np.linspace(0.3, 0.5, 81),
}


def with_pymoo(study: beltspace.Study, evaluations: int) -> np.ndarray:
    """The front that NSGA-II finds: force in N and margin against slip. Each generation is one call."""
    from pymoo.algorithms.moo.nsga2 import NSGA2
    from pymoo.core.problem import Problem
    from pymoo.operators.crossover.sbx import SBX
    from pymoo.operators.mutation.pm import PM
    from pymoo.operators.repair.rounding import RoundingRepair
    from pymoo.operators.sampling.rnd import IntegerRandomSampling
    from pymoo.optimize import minimize

    class Belt(Problem):  # type: ignore[misc]
        def __init__(self) -> None:
            last = [len(levels) - 1 for levels in LEVELS.values()]
            super().__init__(n_var=4, n_obj=2, n_ieq_constr=2, xl=[0] * 4, xu=last, vtype=int)

        def _evaluate(self, x: np.ndarray, out: dict[str, np.ndarray], *_: object, **__: object) -> None:
            found = study.worst({name: levels[at] for (name, levels), at in zip(LEVELS.items(), x.T.astype(int), strict=True)})
            # Where a value has no meaning the design is far from feasible.
            force, slip = np.nan_to_num(found["axial_force_upper_N"], nan=1e9), np.nan_to_num(found["slip_margin"], nan=-10)
            stress = np.nan_to_num(found["stress_margin_margin"], nan=-10)
            out["F"] = np.column_stack([force, -slip])
            out["G"] = np.column_stack([-slip, -stress])

    whole = {"vtype": float, "repair": RoundingRepair()}
    method = NSGA2(pop_size=100, sampling=IntegerRandomSampling(), crossover=SBX(**whole), mutation=PM(**whole), eliminate_duplicates=True)
    found = minimize(Belt(), method, ("n_eval", evaluations), seed=1)
    return np.column_stack([found.F[:, 0], -found.F[:, 1]])


def with_optuna(study: beltspace.Study, evaluations: int) -> np.ndarray:
    """The front that Optuna finds, one design at a time."""
    import optuna

    optuna.logging.set_verbosity(optuna.logging.WARNING)

    def objective(trial: optuna.Trial) -> tuple[float, float]:
        rows = {name: levels[trial.suggest_int(name, 0, len(levels) - 1)] for name, levels in LEVELS.items()}
        row = study.worst(rows).row(0)
        if row["feasible"] != "yes":
            raise optuna.TrialPruned
        return float(row["axial_force_upper_N"]), float(row["slip_margin"])  # type: ignore[arg-type]

    search = optuna.create_study(directions=["minimize", "maximize"], sampler=optuna.samplers.NSGAIISampler(seed=1))
    search.optimize(objective, n_trials=evaluations)
    return np.unique(np.array([trial.values for trial in search.best_trials]), axis=0)


def area(points: np.ndarray, corner: tuple[float, float]) -> float:
    """The area in N that points dominate up to a corner: the larger, the better the front."""
    total, best = 0.0, corner[1]
    for force, margin in sorted(map(tuple, points)):
        if force < corner[0] and margin > best:
            total += (corner[0] - force) * (margin - best)
            best = margin
    return total


def beyond(points: np.ndarray, exact: np.ndarray) -> np.ndarray:
    """Of each design of the exact front: by how many per cent more force a front of others has at least its margin; infinite where it
    reaches no such margin."""
    least = [min((force for force, margin in points if margin >= wanted), default=np.inf) for wanted in exact[:, 1]]
    return 100 * (np.array(least) / exact[:, 0] - 1)


def draw(study: beltspace.Study, fronts: dict[str, np.ndarray], figure: Path) -> None:
    """The fronts beside each other, and what the optimisers miss of the exact one."""
    import matplotlib

    matplotlib.use("agg")
    import matplotlib.pyplot as plt

    (sweep, exact), *others = fronts.items()
    drawing, (left, right) = plt.subplots(1, 2, figsize=(11, 4.4), layout="constrained")
    order = np.argsort(exact[:, 1])
    left.plot(exact[order, 1], exact[order, 0] / 1e3, color="#222222", linewidth=1.2, marker=".", markersize=3, label=f"{sweep}: {len(exact)}")
    edges = np.linspace(0, exact[:, 1].max(), 11)
    middle, width = (edges[:-1] + edges[1:]) / 2, edges[1] / 2.6
    for place, ((name, points), colour, marker) in enumerate(zip(others, ("#0072b2", "#d55e00"), ("o", "^"), strict=True)):
        left.scatter(points[:, 1], points[:, 0] / 1e3, s=22, marker=marker, facecolors="none", edgecolors=colour, label=f"{name}: {len(points)}")
        excess = beyond(points, exact)
        of_bin = [excess[(exact[:, 1] > low) & (exact[:, 1] <= high)] for low, high in zip(edges[:-1], edges[1:], strict=True)]
        most = [max((it for it in bin if np.isfinite(it)), default=0.0) for bin in of_bin]
        at = middle + (place - 0.5) * width
        right.bar(at, most, width, color=colour, label=name)
        for x, top, bin in zip(at, most, of_bin, strict=True):
            lost = int(np.sum(~np.isfinite(bin)))
            if lost:
                right.text(x, top + 0.1, f"{lost} of {len(bin)}\nnot reached", color=colour, ha="center", fontsize=8)
    left.set(title=f"Three fronts of {study.designs:,} designs".replace(",", " "), xlabel="margin against slip, to be large", ylabel="axial force (kN), to be small")
    right.set(title="The worst miss in each tenth of the exact front", xlabel="margin against slip", ylabel="more force than the exact front (%)")
    right.margins(y=0.15)
    for axes in (left, right):
        axes.grid(color="#dddddd", linewidth=0.6)
        axes.set_axisbelow(True)
        axes.legend(frameon=False)
    drawing.savefig(figure, dpi=110, metadata={"Software": None})


def main() -> None:
    words = sys.argv[1:]
    short = "--short" in words
    figure = next((Path(it) for it in words if not it.startswith("-")), None)
    study = beltspace.Study.from_dict(STUDY)
    result = study.sweep()
    exact = np.column_stack([result.front["axial_force_upper_N"], result.front["slip_margin"]])
    corner = (float(exact[:, 0].max()), 0.0)
    fronts = {"exact, by sweep": exact}
    for name, search, evaluations in (("pymoo", with_pymoo, 500 if short else 5000), ("Optuna", with_optuna, 100 if short else 2000)):
        fronts[f"{name}, {evaluations} evaluations"] = search(study, evaluations)
    print(f"{study.designs} designs in {study.scenarios} scenarios each, swept in {result.seconds:.2f} s")
    for name, points in fronts.items():
        print(f"{name}: {len(points)} designs, {area(points, corner) / area(exact, corner):.1%} of the exact front's area")
    if figure:
        draw(study, fronts, figure)


main()
