"""Indices of sensitivity against closed forms, SALib and OpenTURNS; see benches/sensitivity.

Every index is estimated, with an interval of 95 %. Two estimates agree if they are no further apart than their intervals are wide together
(the root of the sum of squares). Of many comparisons a few may miss by chance: at least 85 % must agree, and none may miss by more than twice
that. Otherwise the run ends with exit code 1.
"""
import argparse
import csv
import itertools
import json
import math
import os
import platform
import subprocess
import sys
import tempfile
import time
from datetime import date
from importlib.metadata import version
from pathlib import Path

import numpy as np
import openturns as ot
from SALib.analyze import morris as analyze_morris
from SALib.analyze import sobol as analyze_sobol
from SALib.sample import morris as sample_morris
from SALib.sample import sobol as sample_sobol

sys.path.insert(0, str(Path(__file__).parent))
import probability_numpy  # noqa: E402

LEAST_AGREEING, MOST_APART, SEED = 0.85, 2.0, 1
COEFFICIENTS = (0, 1, 4.5, 9, 99, 99)
DRIVE = {"friction": (0.08, 0.006), "band_thickness_mm": (0.15, 0.004), "torque_Nm": (100, 6), "strength_MPa": (800, 25)}
ANGLE_DEG, TRACTION, RATIO, BANDS, WIDTH_MM = 22, 0.3, 0.8, 8, 9.0
SCREENED = 12


class Case:
    """A function with uncertain inputs: how beltspace is asked for it, the same for numpy, and what is known of its indices."""

    def __init__(self, name, study, quantity, laws, function, model=None, truth=None):
        self.name, self.study, self.quantity, self.laws = name, study, quantity, laws
        self.function, self.model, self.truth = function, model, truth or {}


def study_of(laws, model, more="", drive=""):
    """A study that draws these inputs."""
    return (f'model = "{model}"\n{drive}\n[uncertainty]\n' + "".join(f"{name} = {law}\n" for name, (law, _) in laws.items())
            + f'[probability]\ndraws = 64\nconfirm = 64\n{more}[constraints]\nQUANTITY = {{ DIRECTION }}\n[objectives]\nyield = "max"\n')


def of_formula(name, formula, laws, function, truth, more=""):
    """A case whose function is a formula in a file."""
    inputs = "".join(f"{it} = {{ default = 0 }}\n" for it in laws)
    model = f'[inputs]\noffset = {{ default = 0 }}\n{inputs}[formulas]\ny = "{formula} + offset"\n'
    study = study_of(laws, "function.toml", more, "[design]\noffset = [0]").replace("QUANTITY = { DIRECTION }", "y = { min = -1000 }")
    return Case(name, study, "y", laws, function, model, truth)


def uniform(low, high):
    return f"{{ uniform = [{low!r}, {high!r}] }}", ot.Uniform(low, high)


def normal(mean, sd):
    return f"{{ normal = {{ mean = {mean!r}, sd = {sd!r} }} }}", ot.Normal(mean, sd)


def from_parts(parts, inputs):
    """First-order and total indices and Shapley effects, from the part of the variance of each set of inputs."""
    whole = sum(parts.values())
    of = lambda rule: [sum(part * rule(i, it) for it, part in parts.items() if i in it) / whole for i in range(inputs)]  # noqa: E731
    return {"S1": of(lambda _, it: len(it) == 1), "ST": of(lambda *_: 1), "shapley": of(lambda _, it: 1 / len(it))}


def ishigami():
    """Ishigami and Homma (1990)."""
    a, b = 7, 0.1
    parts = {(0,): 0.5 * (1 + b * math.pi**4 / 5) ** 2, (1,): a * a / 8, (0, 2): 8 * b * b * math.pi**8 / 225}
    laws = {f"x{i}_rad": uniform(-math.pi, math.pi) for i in (1, 2, 3)}
    formula = "sin(x1_rad) + 7 * sin(x2_rad) ^ 2 + 0.1 * (x3_rad / 1[rad]) ^ 4 * sin(x1_rad)"
    return of_formula("Ishigami", formula, laws, lambda x: np.sin(x[:, 0]) + a * np.sin(x[:, 1]) ** 2 + b * x[:, 2] ** 4 * np.sin(x[:, 0]),
                      from_parts(parts, 3))


def sobol_g():
    """Saltelli and Sobol (1995): a product, so that the part of a set is the product of its inputs' own parts."""
    own = [1 / (3 * (1 + a) ** 2) for a in COEFFICIENTS]
    sets = itertools.chain.from_iterable(itertools.combinations(range(len(own)), size) for size in range(1, len(own) + 1))
    laws = {f"x{i + 1}": uniform(0.0, 1.0) for i in range(len(own))}
    formula = " * ".join(f"(abs(4 * x{i + 1} - 2) + {a}) / {1 + a}" for i, a in enumerate(COEFFICIENTS))
    function = lambda x: np.prod((np.abs(4 * x - 2) + COEFFICIENTS) / (1 + np.array(COEFFICIENTS)), axis=1)  # noqa: E731
    return of_formula("Sobol-G", formula, laws, function, from_parts({it: math.prod(own[i] for i in it) for it in sets}, len(own)))


def correlated():
    """Iooss and Prieur (2019): a sum of three normal numbers, of which the last two are correlated. Sobol indices have no meaning."""
    sd, r = 2.0, 0.9
    shared, half = r * sd, 0.5 * r * r
    effects = np.array([1, 1 + shared + half * (sd * sd - 1), sd * sd + shared + half * (1 - sd * sd)])
    laws = {"x1": normal(0.0, 1.0), "x2": normal(0.0, 1.0), "x3": normal(0.0, sd)}
    return of_formula("correlated sum", "x1 + x2 + x3", laws, None, {"shapley": list(effects / effects.sum())},
                      f'correlation = [["x2", "x3", {r}]]\n')


def push_belt(quantity, direction):
    """One push belt in one operating case; SALib and OpenTURNS evaluate its equations in numpy."""
    laws = {name: normal(float(mean), float(sd)) for name, (mean, sd) in DRIVE.items()}
    drive = (f"[fixed]\ngroove_angle_deg = {ANGLE_DEG}\ntraction = {TRACTION}\nratio = {RATIO}\nband_width_mm = {WIDTH_MM}\n"
             f"[design]\nband_count = [{BANDS}]")
    study = study_of(laws, "metal-cvt", drive=drive).replace("QUANTITY = { DIRECTION }", f"{quantity} = {{ {direction} }}")
    radius, *wraps = probability_numpy.geometry(RATIO)

    def function(x):
        friction, thickness, torque, strength = x.T
        _, coefficient = probability_numpy.grip(friction, math.radians(ANGLE_DEG), TRACTION, wraps)
        forces = torque * 1e3 / radius / TRACTION
        if quantity == "axial_force_N":
            return coefficient * forces
        bending = probability_numpy.MODULUS * thickness / 2 * (1 / min(radius, RATIO * radius) - 2 * math.pi / probability_numpy.LENGTH)
        stress = forces * ((1 + TRACTION) / 2) / (2 * BANDS * WIDTH_MM * thickness) + bending
        return 1 - stress / strength

    return Case(f"push belt, {quantity}", study, quantity, laws, function)


def of_beltspace(program, case, draws, folder):
    """Each input's indices with their intervals; seconds of the whole command; evaluations."""
    folder = folder / case.name.replace(" ", "-")
    folder.mkdir(exist_ok=True)
    (folder / "study.toml").write_text(case.study)
    if case.model:
        (folder / "function.toml").write_text(case.model)
    start = time.perf_counter()
    subprocess.run([program, "sensitivity", "study.toml", "--of", case.quantity, "--draws", str(draws), "--seed", str(SEED), "--out", "out",
                    "--quiet"], cwd=folder, check=True)
    seconds = time.perf_counter() - start
    with open(folder / "out/sensitivity.csv") as file:
        rows = list(csv.DictReader(file))
    if [row["names"] for row in rows] != list(case.laws):
        sys.exit(f"{case.name}: the table has {[row['names'] for row in rows]}")
    found = {}
    for name, key in (("S1", "S1"), ("ST", "ST"), ("shapley", "shapley")):
        if all(row[key] for row in rows):
            found[name] = [(float(row[key]), float(row[key + "_conf"] or 0)) for row in rows]
    method = json.loads((folder / "out/sensitivity.json").read_text())["method"]
    return found, seconds, method["sets"] * draws


def of_salib(case, draws):
    """The same of SALib, with its Sobol draws and its intervals from resampling."""
    problem = {"num_vars": len(case.laws), "names": list(case.laws), "bounds": [[0, 1]] * len(case.laws)}
    start = time.perf_counter()
    unit = sample_sobol.sample(problem, draws, calc_second_order=False, seed=SEED)
    x = np.column_stack([np.array(law.computeQuantile(column))[:, 0] for (_, law), column in zip(case.laws.values(), unit.T)])
    told = analyze_sobol.analyze(problem, case.function(x), calc_second_order=False, conf_level=0.95, num_resamples=100, seed=SEED)
    seconds = time.perf_counter() - start
    return {name: list(zip(map(float, told[name]), map(float, told[name + "_conf"]))) for name in ("S1", "ST")}, seconds, len(x)


def of_openturns(case, draws):
    """The same of OpenTURNS: estimators after Martinez with random draws, and their asymptotic intervals."""
    ot.RandomGenerator.SetSeed(SEED)
    inputs = ot.JointDistribution([law for _, law in case.laws.values()])
    function = ot.PythonFunction(len(case.laws), 1, func_sample=lambda x: case.function(np.array(x))[:, None])
    start = time.perf_counter()
    algorithm = ot.MartinezSensitivityAlgorithm(inputs, draws, function, False)
    algorithm.setUseAsymptoticDistribution(True)
    found = {}
    for name, values, interval in (("S1", algorithm.getFirstOrderIndices(), algorithm.getFirstOrderIndicesInterval()),
                                   ("ST", algorithm.getTotalOrderIndices(), algorithm.getTotalOrderIndicesInterval())):
        half = (np.array(interval.getUpperBound()) - np.array(interval.getLowerBound())) / 2
        found[name] = list(zip(map(float, values), map(float, half)))
    return found, time.perf_counter() - start, draws * (len(case.laws) + 2)


def compared(ours, theirs):
    """By how many of their common intervals the indices are apart."""
    return [abs(a - b) / max(math.hypot(c, d), 1e-9) for name in theirs if name in ours for (a, c), (b, d) in zip(ours[name], theirs[name])]


def judged(apart):
    """What is wrong with these distances, if anything."""
    agreeing = sum(it <= 1 for it in apart) / len(apart)
    if agreeing < LEAST_AGREEING:
        return f"only {100 * agreeing:.0f} % of {len(apart)} indices agree"
    return f"an index is {max(apart):.2f} of its intervals away" if max(apart) > MOST_APART else None


def screened(program, folder):
    """Morris screening of a sum with one product against SALib's; ours steps from the 5 % to the 95 % quantile, so does SALib here."""
    laws = {f"x{i + 1}": uniform(0.0, 1.0) for i in range(SCREENED)}
    formula = " + ".join(f"{i + 1} * x{i + 1}" for i in range(SCREENED)) + " + 20 * x1 * x2"
    weights = np.arange(1, SCREENED + 1)
    case = of_formula("screening", formula, laws, lambda x: x @ weights + 20 * x[:, 0] * x[:, 1], {})
    of_beltspace(program, case, 16, folder)
    with open(folder / "screening/out/sensitivity.csv") as file:
        ours = [(float(row["mu_star"]), 1.96 * float(row["sigma"]) / math.sqrt(20)) for row in csv.DictReader(file)]
    problem = {"num_vars": SCREENED, "names": list(laws), "bounds": [[0.05, 0.95]] * SCREENED}
    x = sample_morris.sample(problem, 200, num_levels=4, seed=SEED)
    told = analyze_morris.analyze(problem, x, case.function(x), num_levels=4, seed=SEED)
    theirs = list(zip(map(float, told["mu_star"]), map(float, told["mu_star_conf"])))
    return ours, theirs


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", type=Path)
    parser.add_argument("--short", action="store_true", help="fewer draws")
    parser.add_argument("--out", type=Path, help="write the record, a JSON object")
    request = parser.parse_args()
    program, draws = request.program.resolve(), 1 << 11 if request.short else 1 << 14
    record = {"date": date.today().isoformat(), "cores": os.cpu_count(), "python": platform.python_version(),
              **{name: version(name) for name in ("numpy", "SALib", "openturns")},
              "command": "benches/sensitivity" + (" --short" if request.short else ""), "draws": draws, "cases": []}
    cases = [ishigami(), sobol_g(), correlated(), push_belt("axial_force_N", "max = 1000000"), push_belt("stress_margin", "min = -10")]
    wrong = []
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        for case in cases:
            ours, seconds, evaluations = of_beltspace(program, case, draws, folder)
            row = {"case": case.name, "inputs": list(case.laws), "beltspace": {"seconds": seconds, "evaluations": evaluations, **ours}}
            others = [("closed form", ({name: [(it, 0.0) for it in values] for name, values in case.truth.items()}, None, None))] if case.truth else []
            if case.function:
                others += [("SALib", of_salib(case, draws)), ("OpenTURNS", of_openturns(case, draws))]
            print(f"{case.name}: beltspace {evaluations} evaluations, {seconds:.3f} s")
            for name, (theirs, took, count) in others:
                apart = compared(ours, theirs)
                problem = judged(apart)
                row[name] = {**theirs, "within": sum(it <= 1 for it in apart), "indices": len(apart), "furthest": float(max(apart))}
                spent = "" if took is None else f"; {count} evaluations, {took:.3f} s"
                row[name].update({} if took is None else {"seconds": took, "evaluations": count})
                print(f"  {name}: {row[name]['within']} of {len(apart)} indices within the intervals of 95 %, the furthest at {max(apart):.2f}{spent}")
                wrong += [f"{case.name}, {name}: {problem}"] if problem else []
                # The comparison must notice indices that belong to other inputs.
                moved = {key: values[1:] + values[:1] for key, values in theirs.items()}
                if judged(compared(ours, moved)) is None:
                    wrong.append(f"{case.name}, {name}: indices of other inputs are not noticed")
            record["cases"].append(row)
        ours, theirs = screened(program, folder)
        apart = compared({"mu_star": ours}, {"mu_star": theirs})
        record["screening"] = {"beltspace": ours, "SALib": theirs, "furthest": float(max(apart))}
        print(f"screening of {SCREENED} inputs: mu* of SALib within {max(apart):.2f} of the intervals")
        if problem := judged(apart):
            wrong.append(f"screening: {problem}")
        if judged(compared({"mu_star": ours}, {"mu_star": theirs[1:] + theirs[:1]})) is None:
            wrong.append("screening: effects of other inputs are not noticed")
    if request.out:
        request.out.write_text(json.dumps(record, indent=2, default=float) + "\n")
    sys.exit("; ".join(wrong) or 0)


if __name__ == "__main__":
    main()
