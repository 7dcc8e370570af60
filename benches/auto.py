"""Times `--method auto` beside both methods that it chooses from; see benches/auto.

Every run is a process of its own with a time limit. A study on which auto takes longer than 1.5 times the faster method and a second, or
whose files differ between two methods, is shown and ends the run with exit code 1.
"""
import argparse
import csv
import json
import math
import os
import platform
import random
import re
import subprocess
import sys
import tempfile
import time
from datetime import date
from pathlib import Path

FACTOR, SECONDS = 1.5, 1.0
# About how many seconds judging every design of a study should take.
LEAST, MOST = 0.3, 6.0
DESIGNS = (1e5, 1e9)
# Cells of a map, at most: about as many as a picture shows.
MOST_CELLS = 100_000
# Of each model: evaluations per second of two cores, about; ranges of inputs (the last three words: whole numbers), what may be an objective, and bounds for constraints.
WHOLE = True
MODELS = {
    "metal-cvt": {
        "rate": 3e8,
        "fixed": {"strength_MPa": 800},
        "design": {"groove_angle_deg": (18, 30), "band_thickness_mm": (0.1, 0.4), "band_count": (4, 14, WHOLE), "traction": (0.3, 0.6),
                   "band_width_mm": (6, 14), "belt_length_mm": (600, 700), "ratio": (0.5, 2.0)},
        "scenarios": {"friction": (0.065, 0.095), "torque_Nm": (50, 150), "elastic_modulus_MPa": (190000, 215000)},
        "objectives": {"axial_force_N": "min", "stress_margin": "max", "slip_margin": "max", "torque_capacity_Nm": "max",
                       "capacity_axial_force_N": "min", "band_thickness_mm": "min", "max_stress_MPa": "min"},
        "constraints": {"slip_margin": ("min", 0, 0.2), "stress_margin": ("min", -0.2, 0.4), "torque_capacity_Nm": ("min", 50, 250),
                        "capacity_axial_force_N": ("max", 15000, 50000), "axial_force_N": ("max", 8000, 50000)},
    },
    "rubber-cvt": {
        "rate": 2e8,
        "fixed": {"belt_length_mm": 800, "centre_distance_mm": 210, "strength_MPa": 18},
        "design": {"groove_angle_deg": (24, 34), "belt_width_mm": (20, 50), "belt_thickness_mm": (1, 3), "traction": (0.4, 0.8),
                   "torque_Nm": (5, 15)},
        "scenarios": {"friction": (0.3, 0.45), "ratio": (0.6, 2.2), "elastic_modulus_MPa": (500, 700)},
        "objectives": {"axial_force_N": "min", "stress_margin": "max", "slip_margin": "max", "torque_capacity_Nm": "max"},
        "constraints": {"slip_margin": ("min", 0, 0.2), "stress_margin": ("min", -0.2, 0.4), "axial_force_N": ("max", 200, 2000)},
    },
    "timing-belt": {
        "rate": 5e7,
        "fixed": {"pulley_speed_rpm": 6000},
        "design": {"tooth_compliance_um_per_N": (1.5, 4), "slack_tension_N": (0, 200), "tight_tension_N": (200, 800),
                   "teeth_in_mesh": (16, 26, WHOLE), "pitch_mass_g": (0.3, 0.5)},
        "scenarios": {"friction": (0.3, 0.55), "cord_modulus_GPa": (70, 85)},
        "objectives": {"tight_tension_N": "min", "lift_speed_rpm": "max", "peak_tooth_load_N": "min", "least_tooth_load_N": "max"},
        "constraints": {"effective_tension_N": ("min", 100, 300), "incomplete_teeth": ("max", 0, 6), "least_tooth_load_N": ("min", 0, 3),
                        "peak_tooth_load_N": ("max", 20, 80)},
    },
    "pulley-load": {
        "rate": 3e7,
        "fixed": {"power_kW": 3, "speed_rpm": 3000},
        "design": {"mean_radius_mm": (40, 80), "slack_tension_N": (100, 900), "groove_angle_deg": (34, 38), "groove_count": (1, 6, WHOLE),
                   "wrap_angle_deg": (90, 200)},
        "scenarios": {"friction_direction_deg": (0, 45), "belt_mass_kg_per_m": (0.1, 0.12)},
        "objectives": {"resultant_force_N": "min", "mean_radius_mm": "min", "tight_end_flank_force_N_per_mm": "min",
                       "friction_margin": "max"},
        "constraints": {"friction_margin": ("min", 0, 0.3), "resultant_force_N": ("max", 500, 2500)},
    },
}


def axis(name, low, high, levels, draw):
    spacing = ', spacing = "log"' if low > 0 and draw.random() < 0.2 else ""
    return f"{name} = {{ from = {low}, to = {high}, count = {levels}{spacing} }}"


def a_study(draw, model, number):
    """Lines of a study without its levels: a function of a factor by which the levels of all axes that can be refined grow."""
    it = MODELS[model]
    axes = draw.sample(sorted(it["design"]), draw.randint(2, min(5, len(it["design"]))))
    if all(len(it["design"][name]) == 3 for name in axes):
        axes.append(next(name for name in sorted(it["design"]) if name not in axes))
    # Axes differ in how fine they are.
    shares = {name: math.exp(draw.uniform(-1, 1)) for name in axes}
    scenarios = {name: draw.randint(2, 5) for name in draw.sample(sorted(it["scenarios"]), draw.randint(0, 2))}
    wanted = draw.sample(sorted(it["objectives"]), draw.choice((1, 2, 2, 2, 3)))
    goals = {name: it["objectives"][name] for name in wanted}
    steps = {name: draw.random() < 0.4 for name in wanted}
    bounds = []
    for name in draw.sample(sorted(it["constraints"]), draw.randint(0, min(3, len(it["constraints"])))):
        which, low, high = it["constraints"][name]
        bounds.append(f"{name} = {{ {which} = {draw.uniform(low, high):.4g} }}")
    top = draw.choice((None, draw.choice(wanted)))
    lines = random.Random(draw.random())
    state = lines.getstate()
    # Histograms and maps, as a user would add them to the study.
    more = random.Random(f"report {number}")
    histogram = more.random() < 0.4 and f'histograms = [{{ of = "{more.choice(wanted)}", bins = {more.choice((5, 20, 60))} }}]'
    shown = more.random() < 0.4 and more.choice(('best = "share"', f'value = "{more.choice(wanted)}"'))
    map_axes = more.sample(axes, 2)

    def text(target):
        lines.setstate(state)
        whole = [name for name in axes if len(it["design"][name]) == 3]
        free = [name for name in axes if name not in whole]
        rest = target / math.prod(it["design"][name][1] - it["design"][name][0] + 1 for name in whole)
        mean = (rest / math.prod(shares[name] for name in free)) ** (1 / len(free))
        design, levels = [], {}
        for name in axes:
            low, high = it["design"][name][:2]
            if name in whole:
                levels[name] = high - low + 1
                design.append(f"{name} = {{ from = {low}, to = {high} }}")
            else:
                levels[name] = max(2, min(1_000_000, round(mean * shares[name])))
                design.append(axis(name, low, high, levels[name], lines))
        uncertain = [axis(name, *it["scenarios"][name], count, lines) for name, count in scenarios.items()]
        fixed = [f"{name} = {value}" for name, value in it["fixed"].items() if name not in axes]
        objectives = []
        for name, goal in goals.items():
            step = {"N": 25, "Nm": 2, "rpm": 50, "MPa": 10}.get(name.rsplit("_", 1)[-1], 0.02)
            objectives.append(f'{name} = {{ goal = "{goal}", resolution = {step} }}' if steps[name] else f'{name} = "{goal}"')
        parts = {"design": design, "uncertainty": uncertain, "fixed": fixed, "constraints": bounds, "objectives": objectives}
        report = ["front_budget = 1000000"] + ([f'top = {{ by = "{top}", count = 20 }}'] if top else [])
        report += [histogram] if histogram else []
        if shown and math.prod(levels[name] for name in map_axes) <= MOST_CELLS:
            report.append(f'maps = [{{ x = "{map_axes[0]}", y = "{map_axes[1]}", {shown} }}]')
        body = "\n".join(f"\n[{key}]\n" + "\n".join(rows) for key, rows in {**parts, "report": report}.items() if rows)
        return f'model = "{model}"\ntitle = "Random study {number}"\n{body}\n'

    return text, math.prod(scenarios.values())


def is_too_long(program, study):
    """Would every design take much longer than it should? The time per design differs a hundredfold with the outputs that a study needs."""
    told = subprocess.run([program, "check", study], check=True, stdout=subprocess.PIPE, text=True).stdout
    designs = float(re.search(r"^designs +([\d ]+)$", told, re.M)[1].replace(" ", ""))
    rate = re.search(r"([\d.]+) ([kMG]?)designs/s", told)
    return designs / (float(rate[1]) * {"": 1, "k": 1e3, "M": 1e6, "G": 1e9}[rate[2]]) > 3 * MOST


def drawn(program, seed, number, folder):
    """A random study of a size that is neither too long nor too short to time; its file and model. It follows from the seed."""
    draw = random.Random(f"{seed}/{number}")
    model = sorted(MODELS)[number % len(MODELS)]
    while True:
        text, scenarios = a_study(draw, model, number)
        wanted = math.exp(draw.uniform(math.log(LEAST), math.log(MOST)))
        target = wanted * MODELS[model]["rate"] / scenarios
        if not DESIGNS[0] <= target <= DESIGNS[1]:
            continue
        study = folder / f"study-{number}.toml"
        study.write_text(text(target))
        if not is_too_long(program, study):
            return study, model


def timed(program, study, method, out, limit):
    """Seconds of a sweep, or None if it did not end within the limit; what it says went wrong ends the run."""
    command = [program, "sweep", study, "--engine", "cpu", "--method", method, "--out", out, "--quiet", "--force", "--no-report"]
    start = time.perf_counter()
    process = subprocess.Popen(command, stderr=subprocess.PIPE)
    try:
        said = process.communicate(timeout=limit)[1]
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        return None
    seconds = time.perf_counter() - start
    if process.returncode:
        raise RuntimeError(f"{study} by {method}: {said.decode(errors='replace').strip()}")
    return seconds


def files_of(out):
    return {file.name: file.read_bytes() for file in out.iterdir() if file.name != "run.json"}


def best(first, second):
    return min((it for it in (first, second) if it is not None), default=None)


def is_within(auto, faster):
    return auto is not None and auto <= FACTOR * faster + SECONDS


def one(program, study, folder):
    """Times of the three on one study, and what is wrong with them."""
    outs = {method: folder / method for method in ("exhaustive", "auto", "bounds")}
    every = timed(program, study, "exhaustive", outs["exhaustive"], 20 * MOST)
    if every is None:
        raise RuntimeError(f"{study}: every design takes more than {20 * MOST} s")
    # Beyond this limit bounds are the slower ones, and it does not matter by how much.
    limit = FACTOR * every + SECONDS
    times = {"exhaustive": every, "bounds": timed(program, study, "bounds", outs["bounds"], limit)}
    times["auto"] = timed(program, study, "auto", outs["auto"], 4 * limit)
    if times["auto"] is None:
        raise RuntimeError(f"{study}: auto takes more than {4 * limit:.1f} s, every design {every:.1f} s")
    # The machine may be used by others: if it is close, take the best of several runs.
    for _ in range(5):
        faster = min(it for it in (times["exhaustive"], times["bounds"]) if it is not None)
        if is_within(1.1 * times["auto"], faster):
            break
        for method in times:
            again = limit if method == "bounds" else 4 * limit
            if not (method == "bounds" and times["bounds"] is None):
                times[method] = best(times[method], timed(program, study, method, outs[method], again))
    faster = min(it for it in (times["exhaustive"], times["bounds"]) if it is not None)
    wrong = [] if is_within(times["auto"], faster) else [f"auto takes {times['auto']} s, the faster method {faster:.2f} s"]
    reference = files_of(outs["exhaustive"])
    for method in ("auto", "bounds"):
        if times[method] is not None and files_of(outs[method]) != reference:
            wrong.append(f"the files by {method} are others")
    return times, wrong, json.loads((outs["auto"] / "run.json").read_text())


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", type=Path)
    parser.add_argument("--seed", type=int, default=1, help="which studies are drawn (default 1)")
    parser.add_argument("--studies", type=int, default=40, help="how many (default 40)")
    parser.add_argument("--short", action="store_true", help="four of them")
    parser.add_argument("--keep", type=Path, help="a directory for the studies")
    parser.add_argument("--out", type=Path, help="write the record, a table of comma-separated values")
    request = parser.parse_args()
    program = request.program.resolve()
    count = 4 if request.short else request.studies
    print(f"seed {request.seed}, {count} studies, {os.cpu_count()} threads, {platform.machine()}, {date.today()}", flush=True)
    rows, problems = [], []
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        if request.keep:
            request.keep.mkdir(parents=True, exist_ok=True)
        for number in range(count):
            study, model = drawn(program, request.seed, number, request.keep or folder)
            times, wrong, run = one(program, study, folder)
            bounds = "more" if times["bounds"] is None else f"{times['bounds']:.2f}"
            row = [number, model, run["designs"], run["scenarios"], f"{times['exhaustive']:.2f}", bounds, f"{times['auto']:.2f}", run["method"]]
            rows.append(row)
            print("  ".join(str(it) for it in row), *(f"WRONG: {it}" for it in wrong), flush=True)
            problems += [f"study {number}: {it}" for it in wrong]
    if request.out:
        with request.out.open("w", newline="") as file:
            table = csv.writer(file)
            table.writerow(["seed", "study", "model", "designs", "scenarios", "every_design_s", "bounds_s", "auto_s", "auto_by"])
            table.writerows([request.seed, *row] for row in rows)
    print("\n".join(problems) or f"auto took at most {FACTOR} times as long as the faster method and {SECONDS:g} s on every study")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
