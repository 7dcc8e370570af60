"""Measurements of the pulley: sections per second, load cases on a solved section, and one section beside CalculiX.

Stresses are compared, not only times: a disagreement beyond 3 % ends the run with exit code 1. benches/measures calls this; alone it
is `python3 benches/pulley_measures.py target/release/beltspace [FILE.json]`.
"""
import json
import os
import platform
import shutil
import subprocess
import sys
import tempfile
import time
from datetime import date
from pathlib import Path

SECTIONS = """model = "pulley"
preset = "{preset}"
title = "Sections of one type, each with a mesh and a solution of its own"
[design]
thickness_mm       = {{ from = {thin}, to = {thick}, count = {count} }}
contact_height_mm  = {{ from = 8.6, to = 8.9, count = 10 }}
[constraints]
yield_safety = {{ min = 0 }}
[report]
histograms = [{{ of = "max_stress_MPa", from = 0, to = 2000, bins = 20 }}]
"""
LOADS = """model = "pulley"
title = "Load cases on few sections"
[design]
thickness_mm           = {{ from = 1.6, to = 2.4, count = {sections} }}
power_kW               = {{ from = 1, to = 4, count = 20 }}
friction_direction_deg = {{ from = 0, to = 45, count = {directions} }}
[constraints]
yield_safety = {{ min = 0 }}
[report]
histograms = [{{ of = "max_stress_MPa", from = 0, to = 2000, bins = 20 }}]
"""
# Rows of the equations, and rows that the elimination of one reaches on average.
ROWS = {"pressed-cup": (2343, 24), "double-groove": (3471, 24), "machined": (3699, 166)}


def floor(section):
    """Seconds of a section on one core at 3 GHz if only the arithmetic of its equations took time: 16 harmonics (14 and two that fill the
    lanes), for each and each row 2 (reach^2/2 + 4 x 2 x reach) operations on f64, in two vector units of four or, with AVX-512, eight
    numbers. Bytes: the factors, of the double groove 3471 x 28 x 8 x 8 = 6.2 MB, are written once and read once for eight harmonics."""
    rows, reach = ROWS[section]
    return rows * 16 * 2 * (reach**2 / 2 + 4 * 2 * reach) / (2 * lanes()) / 3e9


def lanes():
    """Numbers in a vector of this processor, as the program chooses it."""
    file = Path("/proc/cpuinfo")
    words = set(file.read_text().split()) if file.exists() else set()
    return 8 if {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"} <= words else 4


def sweep(program, name, text, folder):
    study, out = folder / f"{name}.toml", folder / f"result-{name}"
    study.write_text(text)
    subprocess.run([program, "sweep", study, "--engine", "cpu", "--method", "exhaustive", "--out", out, "--quiet", "--force", "--no-report"], check=True)
    summary, run = (json.loads((out / file).read_text()) for file in ("summary.json", "run.json"))
    return summary, run


def sections(program, preset, thin, thick, count, folder):
    summary, run = sweep(program, f"sections-{preset}", SECTIONS.format(preset=preset, thin=thin, thick=thick, count=count // 10), folder)
    return {"section": preset, "sections": summary["designs"], "feasible": summary["feasible"], "seconds": run["seconds"],
            "threads": run["threads"], "sections_per_second": summary["designs"] / run["seconds"],
            "share_of_floor": summary["designs"] / run["seconds"] * floor(preset) / run["threads"]}


def loads(program, folder):
    """Milliseconds per additional load case on a core: the time of many load cases minus that of few, on the same sections."""
    few = sweep(program, "loads-few", LOADS.format(sections=20, directions=2), folder)
    many = sweep(program, "loads-many", LOADS.format(sections=20, directions=20), folder)
    cases = many[0]["designs"] - few[0]["designs"]
    seconds = many[1]["seconds"] - few[1]["seconds"]
    return {"sections": 20, "cases": cases, "milliseconds_per_case": 1e3 * seconds * many[1]["threads"] / cases}


def beside_calculix(program, sections_per_second, folder):
    """The default pulley in both programs."""
    if not shutil.which("ccx"):
        return None
    deck = folder / "calculix"
    subprocess.run([program, "export", "pulley", "--calculix", deck], check=True, stdout=subprocess.DEVNULL)
    start = time.perf_counter()
    subprocess.run(["ccx", "-i", "pulley"], cwd=deck, check=True, stdout=subprocess.DEVNULL, env={**os.environ, "OMP_NUM_THREADS": "2"})
    seconds = time.perf_counter() - start
    start = time.perf_counter()
    subprocess.run([program, "eval", "pulley", "--json"], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    own = time.perf_counter() - start
    rows = subprocess.run([program, "export", "--calculix", deck, "--compare"], check=True, capture_output=True, text=True).stdout
    worst = 0.0
    for row in (line.split() for line in rows.splitlines()):
        if row[:2] == ["stress", "at"] and row[2][0] in "CDEF":
            worst = max(worst, abs(float(row[-1])))
    if not 0 < worst < 3:
        sys.exit(f"pulley: stresses differ from CalculiX by {worst} %\n{rows}")
    return {"calculix_seconds": seconds, "command_seconds": own, "ratio_of_commands": seconds / own,
            "ratio_in_a_sweep": seconds * sections_per_second, "largest_difference_percent": worst}


def measure(program, folder, short=False):
    count = 300 if short else 2000
    rows = [sections(program, "pressed-cup", 1.4, 2.4, count, folder), sections(program, "double-groove", 1.6, 2.4, count, folder),
            sections(program, "machined", 5, 7, count // 10, folder)]
    return {"sections": rows, "loads": loads(program, folder),
            "calculix": None if short else beside_calculix(program, rows[0]["sections_per_second"], folder)}


def show(record):
    for row in record["sections"]:
        print(f"pulley {row['section']:>14} {row['sections']} sections: {row['seconds']:.2f} s, {row['sections_per_second']:.0f} sections/s "
              f"on {row['threads']} threads, {100 * row['share_of_floor']:.0f} % of the floor")
    row = record["loads"]
    print(f"pulley {row['cases']} further load cases on {row['sections']} sections: {row['milliseconds_per_case']:.2f} ms each on a core")
    if row := record["calculix"]:
        print(f"pulley in CalculiX: {row['calculix_seconds']:.1f} s; this program's command {row['command_seconds']:.3f} s, ratio "
              f"{row['ratio_of_commands']:.0f}; a section of a sweep, ratio {row['ratio_in_a_sweep']:.0f}; stresses at C to F within "
              f"{row['largest_difference_percent']:.2f} %")


def main():
    with tempfile.TemporaryDirectory() as folder:
        record = {"date": date.today().isoformat(), "cores": os.cpu_count(), "machine": processor(),
                  "command": "python3 benches/pulley_measures.py target/release/beltspace", **measure(sys.argv[1], Path(folder))}
    show(record)
    if len(sys.argv) > 2:
        Path(sys.argv[2]).write_text(json.dumps(record, indent=2) + "\n")


def processor():
    names = [line.split(":", 1)[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")] if os.path.exists("/proc/cpuinfo") else []
    return names[0] if names else platform.processor()


if __name__ == "__main__":
    main()
