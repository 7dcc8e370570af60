"""Measures beltspace beside the program that an engineer would write, and prints one table; see benches/measures.

Counts, fronts and values are compared, not only times: a disagreement ends the run with exit code 1.
"""
import argparse
import csv
import json
import math
import os
import platform
import re
import statistics
import subprocess
import sys
import tempfile
import time
from datetime import date
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
import metal_grid  # noqa: E402
from peak import peak_of  # noqa: E402
import pulley_measures  # noqa: E402
import timing_measures  # noqa: E402

STUDY = Path("studies/metal-grid.toml").read_text()
# Operations on f32 per second that lavapipe was measured to make on two cores.
ARITHMETIC = 67e9


def sweep(program, levels, folder, engine="cpu"):
    """Sweeps metal-grid with this many levels per axis on an engine, design by design; returns the result directory, the wall
    time of the whole command and its peak memory in MB."""
    study = folder / f"metal-grid-{levels}.toml"
    study.write_text(STUDY.replace("count = 37", f"count = {levels}"))
    out = folder / f"result-{levels}-{engine}"
    start = time.perf_counter()
    command = [program, "sweep", study, "--engine", engine, "--method", "exhaustive", "--out", out, "--quiet", "--force", "--no-report"]
    process = subprocess.Popen(command)
    peak = peak_of(process)
    if process.returncode:
        sys.exit(f"{command}: exit code {process.returncode}")
    return out, time.perf_counter() - start, peak


def operations(program, levels, folder):
    """Operations of the device's kernel, as it counts them in its text: for a run of designs or a part of one, the designs of a run, those of
    a part, for a design alone."""
    kernel = folder / f"metal-grid-{levels}.wgsl"
    subprocess.run([program, "sweep", folder / f"metal-grid-{levels}.toml", "--emit-shader", kernel], check=True, stdout=subprocess.DEVNULL)
    line = kernel.read_text().splitlines()[1]
    counts = re.fullmatch(r".*: (\d+) for a run of up to (\d+) designs and for a part of up to (\d+), (\d+) for a design that .*", line)
    return [int(number) for number in counts.groups()]


def front_of(out):
    with open(out / "front.csv") as file:
        rows = [(float(row["torque_capacity_Nm"]) * 1e3, float(row["capacity_axial_force_N"])) for row in csv.DictReader(file)]
    return np.array(sorted(rows))


def beside_numpy(program, levels, folder):
    """Both programs on the same grid, counts and front values compared."""
    start = time.perf_counter()
    count, best = metal_grid.with_numpy(metal_grid.axes(levels))
    numpy_seconds = time.perf_counter() - start
    out, seconds, _ = sweep(program, levels, folder)
    summary = json.loads((out / "summary.json").read_text())
    ours, theirs = front_of(out), np.column_stack([-best[:, 0], best[:, 1]])
    theirs = theirs[np.lexsort((theirs[:, 1], theirs[:, 0]))]
    same = summary["feasible"] == count and len(ours) == len(theirs)
    worst = float(np.max(np.abs(ours / theirs - 1))) if same else float("nan")
    if not same or worst > 1e-9:
        sys.exit(f"{levels} levels: numpy finds {count} feasible, front {len(theirs)}; beltspace {summary['feasible']}, "
                 f"front {len(ours)}; largest relative difference {worst}")
    device = on_device(program, levels, folder, out)
    return {"designs": summary["designs"], "feasible": count, "front": len(theirs), "largest_difference": worst,
            "numpy_seconds": numpy_seconds, "beltspace_seconds": seconds, "ratio": numpy_seconds / seconds,
            "gpu": device, "gpu_ratio": numpy_seconds / device["seconds"]}


def on_device(program, levels, folder, expected=None):
    """The same sweep with --engine gpu; its files must be those of the CPU, except for run.json."""
    out, seconds, peak = sweep(program, levels, folder, "gpu")
    if expected is not None:
        for file in expected.iterdir():
            if file.name != "run.json" and file.read_bytes() != (out / file.name).read_bytes():
                sys.exit(f"{levels} levels: {file.name} differs between --engine gpu and --engine cpu")
    run = json.loads((out / "run.json").read_text())
    device = run["device"]
    each, length, part, alone = operations(program, levels, folder)
    # If only the arithmetic of the inner loops took time.
    parts = device["runs_judged_in_parts"] * -(-length // part)
    per_design = each / length + (each * parts + alone * device["judged_singly"]) / device["designs"]
    return {"designs": run["designs"], "seconds": seconds, "sweep_seconds": run["seconds"], "designs_per_second": run["designs"] / seconds,
            "peak_MB": peak, "adapter": device["adapter"], "driver": device["driver"], "tiles": device["tiles"],
            "unsure_designs": device["unsure_designs"], "survivors": device["survivors"],
            "survivors_per_tile": device["survivors"] / device["tiles"],
            "operations_per_run": each, "designs_of_a_run": length, "designs_of_a_part": part, "operations_alone": alone,
            "runs_judged_in_parts": device["runs_judged_in_parts"], "judged_singly": device["judged_singly"],
            "operations_per_design": per_design, "share_of_floor": run["designs"] / run["seconds"] * per_design / ARITHMETIC}


def large(program, folder):
    """1e10 designs: whole command, the peak memory of the child, and the same on a device."""
    out, seconds, peak = sweep(program, 174, folder)
    summary = json.loads((out / "summary.json").read_text())
    return {"designs": summary["designs"], "feasible": summary["feasible"], "front": summary["front"], "seconds": seconds,
            "designs_per_second": summary["designs"] / seconds, "peak_MB": peak, "gpu": on_device(program, 174, folder, out)}


def answers(program):
    """Median milliseconds of commands that people wait for."""
    times = {}
    for command in (["--help"], ["models"], ["models", "metal-cvt"]):
        runs = []
        for _ in range(21):
            start = time.perf_counter()
            subprocess.run([program, *command], check=True, stdout=subprocess.DEVNULL)
            runs.append(1e3 * (time.perf_counter() - start))
        times[" ".join(command)] = statistics.median(runs)
    return times


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("program")
    arguments.add_argument("--out", type=Path)
    arguments.add_argument("--short", action="store_true", help="leave out what takes minutes: 1e9 designs in numpy, 1e10 here")
    arguments.add_argument("--device", action="store_true", help="only 1e11 designs with --engine gpu: a minute or two on a software device")
    arguments = arguments.parse_args()
    record = {"date": date.today().isoformat(), "cores": os.cpu_count(), "machine": processor(), "python": platform.python_version(),
              "numpy": np.__version__, "command": "benches/measures"}
    if arguments.device:
        with tempfile.TemporaryDirectory() as folder:
            device = on_device(arguments.program, 309, Path(folder))
            out = Path(folder) / "result-309-gpu"
            summary = json.loads((out / "summary.json").read_text())
            # As benches/scale compares it.
            record |= {"command": "beltspace sweep metal-grid-309.toml --engine gpu (studies/metal-grid.toml with count = 309)",
                       "feasible": summary["feasible"], "front": summary["front"], "measured": device,
                       "run": json.loads((out / "run.json").read_text())}
        print_device(device)
        return write(arguments.out, record)
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        if not arguments.short:
            record["large"] = large(arguments.program, folder)
        record["answers_ms"] = answers(arguments.program)
        record["timing_belt"] = timing_measures.measure(arguments.program, folder)
        record["pulley"] = pulley_measures.measure(arguments.program, folder, arguments.short)
        sweep(arguments.program, 10, folder)  # the program's pages are read before the clock counts
        record["beside_numpy"] = [beside_numpy(arguments.program, levels, folder) for levels in ((37, 56) if arguments.short else (37, 56, 100))]
    print(f"{record['machine']}, {record['cores']} cores, {record['date']}")
    for row in record["beside_numpy"]:
        print(f"metal-grid {row['designs']:>12} designs  feasible {row['feasible']}  front {row['front']}  values within "
              f"{row['largest_difference']:.1e}  numpy + moocore {row['numpy_seconds']:.2f} s  beltspace "
              f"{row['beltspace_seconds']:.2f} s  ratio {row['ratio']:.1f}")
        print_device(row["gpu"], f"  ratio {row['gpu_ratio']:.1f}")
    if "large" in record:
        row = record["large"]
        print(f"metal-grid {row['designs']:>12} designs  feasible {row['feasible']}  front {row['front']}  {row['seconds']:.1f} s  "
              f"{row['designs_per_second']:.3g} designs/s  peak memory {row['peak_MB']:.0f} MB")
        print_device(row["gpu"])
    timing_measures.show(record["timing_belt"])
    pulley_measures.show(record["pulley"])
    print("answers: " + ", ".join(f"{command} {ms:.1f} ms" for command, ms in record["answers_ms"].items()))
    write(arguments.out, record)


def print_device(row, end=""):
    print(f"  --engine gpu on {row['adapter']}: {row['designs']} designs in {row['seconds']:.2f} s  {row['designs_per_second']:.3g} designs/s, "
          f"{row['operations_per_design']:.1f} operations a design  {100 * row['share_of_floor']:.0f} % of the floor  unsure "
          f"{row['unsure_designs']}  survivors {row['survivors']}  peak memory {row['peak_MB']:.0f} MB{end}")


def write(out, record):
    if out:
        out.write_text(json.dumps(record, indent=2) + "\n")


def processor():
    names = [line.split(":", 1)[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")] if os.path.exists("/proc/cpuinfo") else []
    return names[0] if names else platform.processor()


if __name__ == "__main__":
    main()
