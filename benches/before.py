"""This program beside an earlier revision of itself; see benches/before."""
import argparse
import csv
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from datetime import date
from pathlib import Path

from pulley_measures import SECTIONS, processor
from refined import CVT, cvt, grid

# The last revision before the work on speed whose formulas give the present numbers.
REVISION = "0af84d2"
EIGHT = Path("benches/studies/eight-axes.toml").read_text()
# Of the axial force in N and of both margins: without them the front of four objectives would grow as the grid does.
RESOLUTIONS = [100, 0.01, 0.01]

# What is measured, its study, options, how often it runs, and whether --short runs it.
CASES = [
    ("whole command with its page: traction study", CVT, [], 15, True),
    ("every design: metal-grid, 1.0e9 designs", grid(98), ["--method", "exhaustive"], 3, False),
    ("every design: metal-grid, 1.0e10 designs", grid(174), ["--method", "exhaustive"], 1, False),
    ("every design: traction study, 1.9e6 designs in 434 scenarios", cvt(RESOLUTIONS, 121, 81, 21), ["--method", "exhaustive"], 3, False),
    ("every design: traction study, 1.1e8 designs in 434 scenarios", cvt(RESOLUTIONS, 481, 321, 81), ["--method", "exhaustive"], 1, False),
    ("every design: eight axes in 42 scenarios", EIGHT, ["--method", "exhaustive"], 5, True),
    ("bounds: eight axes in 42 scenarios", EIGHT, ["--method", "bounds"], 3, True),
    ("bounds: traction study, 1.1e8 designs in 434 scenarios", cvt(RESOLUTIONS, 481, 321, 81), ["--method", "bounds"], 1, False),
    ("bounds: metal-grid, 1.08e12 designs", grid(560), ["--method", "bounds"], 1, False),
    ("400 sections of pulleys: pressed cup", SECTIONS.format(preset="pressed-cup", thin=1.4, thick=2.4, count=40), ["--method", "exhaustive"], 3, False),
    ("400 sections of pulleys: double groove", SECTIONS.format(preset="double-groove", thin=1.6, thick=2.4, count=40), ["--method", "exhaustive"], 3, False),
    ("device: metal-grid, 1.0e9 designs", grid(98), ["--method", "exhaustive", "--engine", "gpu"], 1, False),
    ("device: metal-grid, 1.0e10 designs", grid(174), ["--method", "exhaustive", "--engine", "gpu"], 1, False),
    ("device: traction study, 1.9e6 designs in 434 scenarios", cvt(RESOLUTIONS, 121, 81, 21), ["--method", "exhaustive", "--engine", "gpu"], 1, False),
    ("device: traction study, 1.1e8 designs in 434 scenarios", cvt(RESOLUTIONS, 481, 321, 81), ["--method", "exhaustive", "--engine", "gpu"], 1, False),
]


def built(revision, folder):
    """The program of an earlier revision; what was compiled once is kept in target/before."""
    source = folder / "source"
    subprocess.run(["git", "clone", "--quiet", "--shared", ".", source], check=True)
    subprocess.run(["git", "checkout", "--quiet", revision], cwd=source, check=True)
    target = Path("target/before").absolute()
    subprocess.run(["cargo", "build", "--release", "--locked", "--quiet", "--bin", "beltspace"], cwd=source, check=True,
                   env={**os.environ, "CARGO_TARGET_DIR": str(target)})
    return shutil.copy(target / "release" / "beltspace", folder / "program")


def run(program, study, options, out):
    """Processor time and time of a sweep in s."""
    has_page = not options
    engine = [] if "--engine" in options else ["--engine", "cpu"]
    command = [program, "sweep", study, *options, *engine, "--out", out, "--force", "--quiet", *([] if has_page else ["--no-report"])]
    start = time.perf_counter()
    process = subprocess.Popen(command)
    _, status, used = os.wait4(process.pid, 0)
    seconds = time.perf_counter() - start
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise SystemExit(f"{' '.join(map(str, command))}: exit code {process.returncode}")
    return used.ru_utime + used.ru_stime, seconds


def found(out):
    """How many designs are feasible, and all tables: of a front the indices and, as texts, values."""
    tables = {file.name: list(csv.reader(file.open())) for file in out.glob("*.csv")}
    return json.loads((out / "summary.json").read_text())["feasible"], tables


def one(case, programs, folder):
    """Least processor times of both programs, in turns; their answers must be the same."""
    name, text, options, runs, _ = case
    study = folder / "study.toml"
    study.write_text(text)
    times = {which: [] for which in programs}
    for _ in range(runs):
        for which, program in programs.items():
            times[which].append(run(program, study, options, folder / which))
    answers = [found(folder / which) for which in programs]
    if answers[0] != answers[1]:
        raise SystemExit(f"{name}: both programs find different designs")
    earlier, now = (min(times[which]) for which in programs)
    return {"case": name, "runs": runs, "earlier_processor_s": round(earlier[0], 3), "processor_s": round(now[0], 3),
            "earlier_s": round(earlier[1], 3), "s": round(now[1], 3), "times_faster": round(earlier[0] / now[0], 2)}


def main():
    arguments = argparse.ArgumentParser(prog="benches/before", description=__doc__)
    arguments.add_argument("program", help=argparse.SUPPRESS)
    arguments.add_argument("--revision", default=REVISION, help="of the earlier program [default: %(default)s]")
    arguments.add_argument("--earlier", type=Path, help="an earlier program that is built already")
    arguments.add_argument("--out", type=Path, metavar="FILE.json", help="where the record goes")
    arguments.add_argument("--short", action="store_true", help="only what takes seconds")
    arguments.add_argument("--no-gpu", action="store_true", help="without the cases that need a device")
    given = arguments.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        earlier = given.earlier or built(given.revision, folder)
        programs = {"earlier": earlier, "now": given.program}
        for case in CASES:
            if given.short and not case[4] or given.no_gpu and "gpu" in case[2]:
                continue
            row = one(case, programs, folder)
            rows.append(row)
            print(f"{row['case']:<62} {row['earlier_processor_s']:9.3f} s  {row['processor_s']:8.3f} s  {row['times_faster']:6.2f} times", flush=True)
    record = {"date": date.today().isoformat(), "machine": processor(), "cores": os.cpu_count(), "revision": given.revision,
              "command": " ".join(["benches/before", *sys.argv[2:]]), "cases": rows}
    if given.out:
        given.out.write_text(json.dumps(record, indent=1) + "\n")


main()
