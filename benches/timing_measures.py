"""Measurements of the timing belt: the map of the boundary tooth beside numba, and a sweep in which the belt varies too.

Counts are compared, not only times: a disagreement ends the run with exit code 1.
"""
import csv
import json
import subprocess
import sys
import time

import numpy as np

import timing_map

MAP = """model = "timing-belt"
title = "The map of benches/timing_map.py"
[design]
tight_tension_N  = {{ from = 60, to = 800, count = {levels} }}
pulley_speed_rpm = {{ from = 500, to = 8000, count = {levels} }}
[report]
histograms = [{{ of = "boundary_tooth", from = 0.5, to = 24.5, bins = 24 }}]
"""
BELTS = """model = "timing-belt"
title = "A million belts, each under a hundred loads"
[design]
friction                  = { from = 0.3, to = 0.55, count = 10 }
tooth_compliance_um_per_N = { from = 1.5, to = 4, count = 10 }
cord_modulus_GPa          = { from = 60, to = 90, count = 10 }
pitch_mass_g              = { from = 0.3, to = 0.5, count = 10 }
tooth_length_mm           = { from = 5, to = 7, count = 10 }
pressure_angle_deg        = { from = 15, to = 25, count = 10 }
pulley_speed_rpm          = { from = 1000, to = 6000, count = 10 }
tight_tension_N           = { from = 100, to = 1000, count = 10 }
[constraints]
incomplete_teeth = { max = 0 }
[report]
histograms = [{ of = "boundary_tooth", from = 0.5, to = 24.5, bins = 24 }]
"""
# Seconds of a belt on one core at 3 GHz if only its arithmetic took time. The loads: 100 of them, 23 teeth at most, 6
# operations on f64 each (two products, a sum, a difference, a choice, a count), eight to a cycle in two vector units. The belt: 22
# gaps and 23 teeth of about 14 dependent operations and two divisions, one after the other, and ten transcendental functions of
# 20 ns. Bytes do not count: a belt's two tables of 23 numbers stay in the first-level cache.
FLOOR_BELT = (100 * 23 * 6 / 8 + 45 * (14 + 2 * 5)) / 3e9 + 10 * 20e-9


def sweep(program, name, text, folder):
    """Sweeps a study; returns the result directory and the wall time of the whole command."""
    study, out = folder / f"{name}.toml", folder / f"result-{name}"
    study.write_text(text)
    start = time.perf_counter()
    subprocess.run([program, "sweep", study, "--engine", "cpu", "--method", "exhaustive", "--out", out, "--quiet", "--force", "--no-report"], check=True)
    return out, time.perf_counter() - start


def beside_numba(program, levels, folder):
    """The map in beltspace and in numba, one after the other: pairs per boundary tooth compared, times and their ratios."""
    axes = timing_map.axes(levels)
    counts, seconds = {}, {}
    for run in (timing_map.per_pair, timing_map.solved_once):
        run(*timing_map.axes(8))  # compiled before the clock counts
        start = time.perf_counter()
        counts[run.__name__] = run(*axes)
        seconds[run.__name__] = time.perf_counter() - start
    out, own = min((sweep(program, f"map-{levels}", MAP.format(levels=levels), folder) for _ in range(3)), key=lambda it: it[1])
    with open(out / "histogram-boundary_tooth.csv") as file:
        found = np.array([int(row["designs"]) for row in csv.DictReader(file)][1:-1])
    for name, expected in counts.items():
        if not (found == expected[1:]).all():
            sys.exit(f"{levels} levels: pairs per boundary tooth differ: beltspace {found}, numba {name} {expected[1:]}")
    return {"pairs": levels**2, "beltspace_seconds": own, "numba_per_pair_seconds": seconds["per_pair"],
            "numba_solved_once_seconds": seconds["solved_once"], "ratio_per_pair": seconds["per_pair"] / own,
            "ratio_solved_once": seconds["solved_once"] / own}


def belts(program, folder):
    """1e6 belts with 100 loads each."""
    out, seconds = sweep(program, "belts", BELTS, folder)
    summary, run = (json.loads((out / name).read_text()) for name in ("summary.json", "run.json"))
    belts = summary["designs"] // 100
    return {"belts": belts, "loads": 100, "feasible": summary["feasible"], "seconds": seconds, "belts_per_second": belts / run["seconds"],
            "share_of_floor": belts / run["seconds"] * FLOOR_BELT / run["threads"]}


def measure(program, folder):
    return {"map": beside_numba(program, 10_000, folder), "belts": belts(program, folder)}


def show(record):
    row = record["map"]
    print(f"timing-belt {row['pairs']:>11} pairs of speed and tension: {row['beltspace_seconds']:.2f} s; numba solving every pair "
          f"{row['numba_per_pair_seconds']:.2f} s, ratio {row['ratio_per_pair']:.1f}; numba with the belt solved once "
          f"{row['numba_solved_once_seconds']:.2f} s, ratio {row['ratio_solved_once']:.2f}; pairs per tooth equal")
    row = record["belts"]
    print(f"timing-belt {row['belts']:>11} belts x {row['loads']} loads: {row['seconds']:.2f} s, {row['belts_per_second']:.3g} belts/s, "
          f"{100 * row['share_of_floor']:.0f} % of the floor")
