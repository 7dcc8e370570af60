"""Yields in beltspace and in numpy, draw by draw; see benches/probability.

Every design's count of draws that hold must be the same in both. A difference, more than 1 GB, or (without --short) less than ten times the
speed of numpy ends the run with exit code 1.
"""
import argparse
import csv
import json
import os
import platform
import re
import resource
import subprocess
import sys
import tempfile
import time
from datetime import date
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
import probability_numpy  # noqa: E402
from peak import peak_of  # noqa: E402

LEAST_RATIO, MOST_MB = 10, 1000 / 1.048576
DRAWS = 4096
CASES = ((0.5, 60), (0.8, 80), (1.25, 100), (2, 120))
LIMITS = {"traction": 0.35, "axial_force_N": 40000, "cases": CASES}
STUDY = """model = "metal-cvt"
title = "Push belts, draw by draw"

[design]
groove_angle_deg  = {{ from = 18, to = 28, count = {angles} }}
band_thickness_mm = {{ from = 0.10, to = 0.20, count = {thicknesses} }}
band_count        = {{ from = 5, to = 14 }}
band_width_mm     = {{ from = 7, to = 11.5, count = {widths} }}

[operation]
cases = [{cases}]

[uncertainty]
friction     = {{ normal = {{ mean = 0.08, sd = 0.006 }}, from = 0.05, to = 0.11 }}
torque_Nm    = {{ times = {{ gumbel = {{ mode = 0.95, scale = 0.06 }} }} }}
strength_MPa = {{ lognormal = {{ mean = 800, sd = 25 }} }}

[probability]
draws   = {draws}
confirm = 1

[fixed]
traction = {traction}

[constraints]
slip_margin   = {{ min = 0 }}
stress_margin = {{ min = 0 }}
axial_force_N = {{ max = {axial_force_N} }}

[objectives]
yield         = "max"
band_width_mm = "min"

[report]
histograms = [{{ of = "yield", bins = {bins}, from = {first}, to = {last} }}]
{top}
"""
# Levels of the angle, the thickness and the width; the band count has 10.
LARGE, MEDIUM, LISTED = (20, 25, 20), (5, 10, 10), (5, 5, 4)

# A sweep of many draws, with a yield that designs must have and without, and the seconds that the first should take at most.
MANY, MANY_DRAWS, MANY_CASES, LEAST_YIELD, MANY_SECONDS = (20, 50, 100), 100_000, CASES[:1], 0.999, 240

# Uncertain inputs of the study whose yields are bounded, and how long bounds 1e-4 apart should take for the first 2, 3 and 4 of them.
LAWS = (
    "friction = { normal = { mean = 0.08, sd = 0.006 }, from = 0.05, to = 0.11 }",
    "band_thickness_mm = { times = { normal = { mean = 1, sd = 0.005 } } }",
    "strength_MPa = { lognormal = { mean = 800, sd = 16 } }",
    "elastic_modulus_MPa = { normal = { mean = 210000, sd = 2000 } }",
)
TARGETS = {2: 0.05, 3: 0.5, 4: 5.0}
FORCES = (24000, 27000, 30000)
BOUNDED = """model = "metal-cvt"
[design]
clamping_force_N = [{forces}]
[fixed]
{strength}
[operation]
ratio = [0.5, 2]
torque_Nm = [100]
[uncertainty]
{laws}
[probability]
draws = 1
confirm = 1
enclosure = true
[constraints]
slip_margin = {{ min = 0 }}
stress_margin = {{ min = 0.13 }}
yield = {{ min = 0.999 }}
[objectives]
clamping_force_N = "min"
"""


def text_of(levels, top=0, draws=DRAWS, operation=CASES):
    """The study with so many levels. Each bin of the histogram holds one count of draws."""
    cases = ", ".join(f"{{ ratio = {ratio}, torque_Nm = {torque} }}" for ratio, torque in operation)
    angles, thicknesses, widths = levels
    listed = f'top = {{ by = "yield", count = {top} }}' if top else ""
    half = 0.5 / DRAWS
    return STUDY.format(angles=angles, thicknesses=thicknesses, widths=widths, cases=cases, draws=draws, bins=DRAWS + 1, first=-half,
                        last=1 + half, top=listed, traction=LIMITS["traction"], axial_force_N=LIMITS["axial_force_N"])


def designs_of(levels):
    """Every design in the order of their numbers, in radians and millimetres."""
    angles, thicknesses, widths = levels
    axes = (np.radians(np.linspace(18, 28, angles)), np.linspace(0.10, 0.20, thicknesses), np.arange(5.0, 15.0), np.linspace(7, 11.5, widths))
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 4)


def sweep(program, levels, folder, top=0):
    """Sweeps the study with so many levels; see `sweep_text`."""
    return sweep_text(program, text_of(levels, top), folder)


def sweep_text(program, text, folder):
    """Sweeps a study; the result directory, seconds of the whole command by the clock and of the processor, and its peak memory in MB."""
    study, out = folder / "study.toml", folder / f"result-{len(list(folder.iterdir()))}"
    study.write_text(text)
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    process = subprocess.Popen([program, "sweep", study, "--out", out, "--quiet", "--no-report"])
    peak = peak_of(process)
    clock, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    if process.returncode:
        sys.exit(f"the sweep of {study} ended with {process.returncode}")
    return out, clock, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, peak


def draws_of(program, folder):
    """The draws that choose, as `check` writes them: friction, factor of the torque, strength."""
    study, table = folder / "draws.toml", folder / "draws.csv"
    study.write_text(text_of(LISTED))
    subprocess.run([program, "check", study, "--draws", table], check=True, stdout=subprocess.DEVNULL)
    with open(table) as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == DRAWS and [int(row["draw"]) for row in rows] == list(range(DRAWS))
    return tuple(np.array([float(row[name]) for row in rows]) for name in ("friction", "torque_Nm_times", "strength_MPa"))


def counts_of_list(out, designs):
    """How many draws hold, of each design of a study whose list has all that are feasible: those of which a draw holds."""
    with open(out / "top.csv") as file:
        rows = list(csv.DictReader(file))
    listed = [int(row["design_index"]) for row in rows]
    if len(set(listed)) != len(listed) or len(listed) != json.loads((out / "summary.json").read_text())["feasible"]:
        sys.exit(f"{out}/top.csv does not have each feasible design once")
    found = np.zeros(designs, np.int64)
    for row in rows:
        share = float(row["yield_screened"]) * DRAWS
        if share != round(share):
            sys.exit(f"{share} draws hold of design {row['design_index']}")
        if share < 1:
            sys.exit(f"no draw holds of the listed design {row['design_index']}")
        found[int(row["design_index"])] = round(share)
    return found


def counts_of_histogram(out):
    """How many designs have 0, 1, 2 and more draws that hold. Designs without such a draw are not feasible: no bin counts them."""
    (file,) = out.glob("histogram-*.csv")
    with open(file) as rows:
        below, *counts, above = (int(row["designs"]) for row in csv.DictReader(rows))
    assert below == above == counts[0] == 0 and len(counts) == DRAWS + 1
    summary = json.loads((out / "summary.json").read_text())
    counts[0] = summary["designs"] - summary["feasible"]
    return np.array(counts)


def differing(ours, theirs):
    """How many counts differ."""
    return int(np.count_nonzero(ours != theirs))


def compare_list(program, draws, folder):
    """Design by design: the counts of a study whose designs are all listed. The comparison must notice a count that is off by one, and one draw
    that slips instead of holding."""
    designs = designs_of(LISTED)
    out, *_ = sweep(program, LISTED, folder, len(designs))
    ours, theirs = counts_of_list(out, len(designs)), probability_numpy.counts(designs, draws, LIMITS)
    wrong = differing(ours, theirs)
    if wrong:
        first = np.flatnonzero(ours != theirs)[0]
        sys.exit(f"{wrong} of {len(designs)} designs have another count; first design {first}: beltspace {ours[first]}, numpy {theirs[first]}")
    one_more = theirs.copy()
    one_more[len(designs) // 2] += 1
    slips = tuple(column.copy() for column in draws)
    slips[0][np.argmax(draws[0])] = 0.01
    if differing(ours, one_more) != 1 or differing(ours, probability_numpy.counts(designs, slips, LIMITS)) == 0:
        sys.exit("the comparison does not notice a wrong count or a wrong draw")
    shares = ours / DRAWS
    return {"designs": len(designs), "evaluations": len(designs) * DRAWS * len(CASES), "all_counts_equal": True,
            "yields": {"none": int(np.sum(shares == 0)), "between": int(np.sum((shares > 0) & (shares < 1))), "all": int(np.sum(shares == 1))}}


def compare_all(program, levels, draws, folder, runs):
    """All designs of a study: beltspace and numpy, which computes every equation for every design and draw, or hoists what hangs on the groove
    angle alone. How many designs have 0, 1, 2 ... draws that hold must be the same."""
    designs = designs_of(levels)
    times, peak = [], 0
    for _ in range(runs):
        out, clock, processor, memory = sweep(program, levels, folder)
        times.append((clock, processor))
        peak = max(peak, memory)
    beside = {}
    for name, is_hoisted in (("numpy", False), ("numpy_hoisted", True)):
        start, before = time.perf_counter(), time.process_time()
        theirs = probability_numpy.counts(designs, draws, LIMITS, is_hoisted)
        beside[name] = {"seconds": time.perf_counter() - start, "processor_seconds": time.process_time() - before}
        ours, expected = counts_of_histogram(out), np.bincount(theirs, minlength=DRAWS + 1)
        wrong = differing(ours, expected)
        one_off = theirs.copy()
        one_off[np.argmin(np.abs(theirs - DRAWS // 2))] += 1
        if wrong or differing(ours, np.bincount(one_off, minlength=DRAWS + 1)) == 0:
            sys.exit(f"{wrong} of {DRAWS + 1} counts are those of other numbers of designs in {name}, or none where one is wrong")
    clock, processor = min(it[0] for it in times), min(it[1] for it in times)
    evaluations = len(designs) * DRAWS * len(CASES)
    return {"designs": len(designs), "draws": DRAWS, "cases": len(CASES), "evaluations": evaluations, "seconds": clock,
            "processor_seconds": processor, "evaluations_per_second": evaluations / clock, "peak_MB": peak, **beside,
            "ratio": beside["numpy"]["seconds"] / clock, "ratio_hoisted": beside["numpy_hoisted"]["seconds"] / clock}


def many(program, folder):
    """Many draws of many designs: those that must have a yield, of which the others end early, and all of them to the last draw."""
    whole = text_of(MANY, draws=MANY_DRAWS, operation=MANY_CASES)
    asked = whole.replace("[objectives]\nyield         = \"max\"\n", f"yield = {{ min = {LEAST_YIELD} }}\n[objectives]\n")
    assert asked != whole
    rows, evaluations = {}, 10 * MANY[0] * MANY[1] * MANY[2] * MANY_DRAWS * len(MANY_CASES)
    for name, text in (("early_end", asked), ("all_draws", whole)):
        out, clock, processor, memory = sweep_text(program, text, folder)
        summary = json.loads((out / "summary.json").read_text())
        rows[name] = {"seconds": clock, "processor_seconds": processor, "evaluations_per_second": evaluations / clock, "peak_MB": memory,
                      "feasible_share": summary["feasible"] / summary["designs"]}
    return {"designs": summary["designs"], "draws": MANY_DRAWS, "cases": len(MANY_CASES), "least_yield": LEAST_YIELD, **rows}


def enclosures(program, folder):
    """Seconds of a whole `eval` that proves bounds of a design's yield, the best of three, and how far the bounds are apart."""
    rows = []
    for inputs, target in TARGETS.items():
        study = folder / f"bounded-{inputs}.toml"
        fixed = "" if any(law.startswith("strength") for law in LAWS[:inputs]) else "strength_MPa = 800"
        study.write_text(BOUNDED.format(forces=", ".join(map(str, FORCES)), strength=fixed, laws="\n".join(LAWS[:inputs])))
        for design, force in enumerate(FORCES):
            seconds = []
            for _ in range(3):
                start = time.perf_counter()
                told = subprocess.run([program, "eval", study, "--design", str(design)], check=True, capture_output=True, text=True).stdout
                seconds.append(time.perf_counter() - start)
            least, most = (float(re.search(rf"^ *{name} +(\S+)", told, re.M)[1]) for name in ("yield_at_least", "yield_at_most"))
            boxes, apart = re.search(r"([\d ]+) boxes, (\S+) apart", told).groups()
            # The budget is boxes, not time: on every machine the bounds come equally close.
            if float(apart.rstrip(",")) > 1e-4:
                sys.exit(f"bounds of a yield with {inputs} inputs at {force} N stay {apart} apart: 1e-4 is wanted")
            rows.append({"inputs": inputs, "clamping_force_N": force, "at_least": least, "at_most": most, "width": float(apart.rstrip(",")),
                         "boxes": int(boxes.replace(" ", "")), "seconds": min(seconds), "target_seconds": target,
                         "is_met": min(seconds) <= target and float(apart.rstrip(",")) <= 1e-4})
    return rows


def processor():
    lines = open("/proc/cpuinfo").read().splitlines() if os.path.exists("/proc/cpuinfo") else []
    return next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), platform.processor())


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", type=Path)
    parser.add_argument("--short", action="store_true", help="fewer designs; counts and memory are checked, times are not")
    parser.add_argument("--many", action="store_true", help="also 1e6 designs with 1e5 draws each: some minutes")
    parser.add_argument("--out", type=Path, help="write the record, a JSON object")
    request = parser.parse_args()
    program = request.program.resolve()
    record = {"date": date.today().isoformat(), "cores": os.cpu_count(), "machine": processor(), "python": platform.python_version(),
              "numpy": np.__version__, "command": "benches/probability" + (" --short" if request.short else "") + (" --many" if request.many else "")}
    print(f"{record['machine']}, {record['cores']} cores, {record['date']}, numpy {np.__version__} on one core", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        draws = draws_of(program, folder)
        record["listed"] = compare_list(program, draws, folder)
        print(f"{record['listed']['designs']} designs x {DRAWS} draws x {len(CASES)} cases: all counts equal numpy's; yields {record['listed']['yields']}",
              flush=True)
        record["all"] = it = compare_all(program, MEDIUM if request.short else LARGE, draws, folder, 1 if request.short else 3)
        print(f"{it['designs']} designs x {DRAWS} draws x {len(CASES)} cases, {it['evaluations']:.2e} evaluations: as many designs with each count\n"
              f"  beltspace {it['seconds']:.2f} s, processor {it['processor_seconds']:.2f} s, {it['evaluations_per_second']:.2e}/s, peak memory {it['peak_MB']:.0f} MB\n"
              f"  numpy {it['numpy']['seconds']:.2f} s, processor {it['numpy']['processor_seconds']:.2f} s, ratio {it['ratio']:.1f}; what hangs on the angle "
              f"alone computed once per angle {it['numpy_hoisted']['seconds']:.2f} s, ratio {it['ratio_hoisted']:.1f}", flush=True)
        if request.many:
            record["many"] = them = many(program, folder)
            early, full = them["early_end"], them["all_draws"]
            print(f"{them['designs']} designs x {MANY_DRAWS} draws, a yield of {LEAST_YIELD} asked for: {early['seconds']:.1f} s, "
                  f"{early['feasible_share']:.1%} have it\n  all draws of all designs: {full['seconds']:.1f} s, {full['evaluations_per_second']:.2e}/s", flush=True)
        record["enclosures"] = enclosures(program, folder)
        for row in record["enclosures"]:
            print(f"bounds of a yield, {row['inputs']} inputs, {row['clamping_force_N']} N: {row['at_least']:.6g} to {row['at_most']:.6g}, {row['width']:.1e} "
                  f"apart, {row['boxes']} boxes, {row['seconds']:.3f} s ({row['target_seconds']} s wanted)", flush=True)
    if request.out:
        request.out.write_text(json.dumps(record, indent=2) + "\n")
    wrong = []
    if it["peak_MB"] > MOST_MB:
        wrong.append(f"a peak of {it['peak_MB']:.0f} MB is more than 1 GB")
    if not request.short and it["ratio"] < LEAST_RATIO:
        wrong.append(f"a ratio of {it['ratio']:.1f} to numpy is less than {LEAST_RATIO}")
    if request.many and early["seconds"] > MANY_SECONDS:
        wrong.append(f"{them['designs']} designs with {MANY_DRAWS} draws took {early['seconds']:.0f} s, more than {MANY_SECONDS}")
    sys.exit("; ".join(wrong) or 0)


if __name__ == "__main__":
    main()
