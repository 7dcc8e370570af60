"""Compares the memory that `check` estimates with the peak of whole runs; see benches/memory. Needs only Python, and Linux."""
import argparse
import csv
import os
import re
import resource
import subprocess
import tempfile
import time
from pathlib import Path

LEAST, MOST = 1.0, 1.25
MB = 1e6

MAP = """model = "metal-cvt"
[objectives]
axial_force_N = "min"
[design]
ratio = {{ from = 0.5, to = 2, count = {n} }}
friction = {{ from = 0.05, to = 0.09, count = {n} }}
[report]
maps = [{{ x = "ratio", y = "friction", {what} }}]
"""
SHARE, BEST = 'best = "share"', 'value = "axial_force_N", best = "min"'
SCENARIOS = """model = "metal-cvt"
[design]
band_count = [6, 7]
[uncertainty]
ratio = { from = 0.5, to = 2, count = 5000 }
friction = { from = 0.05, to = 0.09, count = 4000 }
[objectives]
torque_capacity_Nm = "max"
"""
# Two objectives that conflict in every case, so that all designs are on the front.
CASES = """model = "metal-cvt"
[design]
cases = {{ csv = "cases-{n}.csv" }}
[objectives]
torque_Nm = "min"
strength_MPa = "max"
[report]
front_budget = 10000000
"""
FRONT = """model = "metal-cvt"
[design]
groove_angle_deg = { from = 18, to = 30, count = 81 }
band_thickness_mm = { from = 0.10, to = 0.30, count = 41 }
band_count = { from = 6, to = 14 }
traction = { from = 0.30, to = 0.50, count = 41 }
[operation]
torque_Nm = [150]
[constraints]
slip_margin = { min = 0 }
stress_margin = { min = 0 }
[objectives]
axial_force_N = "min"
stress_margin = "max"
slip_margin = "max"
band_count = "min"
"""
VARIANTS = """model = "metal-cvt"
[objectives]
axial_force_N = "min"
[design]
ratio = { from = 0.5, to = 2, count = 100 }
friction = { from = 0.05, to = 0.09, count = 100 }
[report]
variants = true
"""
# Seconds that a short run takes.
SHORT = 3
# Left out by --short.
SLOW = {"pulley-design", "map of shares, 8192 x 8192", "scenarios, 2e7", "cases, 800000"}


def cases(folder, n):
    with open(folder / f"cases-{n}.csv", "w") as file:
        file.write("torque_Nm,strength_MPa\n")
        file.writelines(f"{i + 10},{i + 10}\n" for i in range(n))
    return CASES.format(n=n)


def studies(folder):
    """Every study: its name and file."""
    yield from ((path.stem, path) for path in sorted(Path("studies").glob("*.toml")))
    texts = {
        "map of shares, 512 x 512": MAP.format(n=512, what=SHARE),
        "map of shares, 3000 x 3000": MAP.format(n=3000, what=SHARE),
        "map of the best, 3000 x 3000": MAP.format(n=3000, what=BEST),
        "map of shares, 8192 x 8192": MAP.format(n=8192, what=SHARE),
        "scenarios, 2e7": SCENARIOS,
        "cases, 20000": cases(folder, 20_000),
        "cases, 800000": cases(folder, 800_000),
        "front of four objectives": FRONT,
        "list of all designs": VARIANTS,
    }
    for number, (name, text) in enumerate(texts.items()):
        path = folder / f"study-{number}.toml"
        path.write_text(text)
        yield name, path


def said(program, study):
    """The memory in MB and the size of the front that `check` estimates."""
    text = subprocess.run([program, "check", study], check=True, capture_output=True, text=True).stdout
    memory, front = re.search(r"^memory +about (\d+) MB(?:, with about ([\d ,]+) designs)?", text, re.M).groups()
    return int(memory), re.sub(r"\D", "", front or "0")


def peak(program, study, folder):
    """The largest resident memory of a sweep in MB, of three runs where one is short: peaks scatter."""
    start = time.monotonic()
    most = peak_of_one(program, study, folder)
    if time.monotonic() - start > SHORT:
        return most
    return max(most, *(peak_of_one(program, study, folder) for _ in range(2)))


def peak_of_one(program, study, folder):
    process = subprocess.Popen([program, "sweep", study, "--out", folder / "out", "--force", "--quiet"])
    _, status, used = os.wait4(process.pid, 0)
    if status:
        raise SystemExit(f"{study}: the sweep ended with {os.waitstatus_to_exitcode(status)}")
    # A process that was forked from a larger one is said to be as large.
    assert used.ru_maxrss > resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, "this script takes more memory than a sweep"
    return used.ru_maxrss * 1024 / MB


def fits(said, measured):
    return LEAST <= said / measured <= MOST


def main():
    assert fits(110, 100) and not fits(99, 100) and not fits(126, 100)
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("--out", type=Path, help="write the table there, too")
    parser.add_argument("--short", action="store_true", help="leave out what takes minutes")
    parser.add_argument("--only", help="studies whose names have this in them")
    request = parser.parse_args()
    rows, wrong = [], []
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        for name, study in studies(folder):
            if (request.short and name in SLOW) or (request.only and request.only not in name):
                continue
            (expected, front), measured = said(request.program, study), peak(request.program, study, folder)
            is_right = fits(expected, measured)
            wrong += [] if is_right else [name]
            rows.append((name, expected, f"{measured:.1f}", f"{expected / measured:.2f}", front))
            print(f"{name:32} said {expected:5} MB, measured {measured:7.1f} MB, ratio {expected / measured:.2f}"
                  f"{'' if is_right else '  WRONG'}", flush=True)
    if request.out:
        with request.out.open("w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(["study", "said_MB", "measured_peak_MB", "ratio", "expected_front"])
            writer.writerows(rows)
    if wrong:
        raise SystemExit(f"check is not {LEAST} to {MOST} times the peak for: {', '.join(wrong)}")


if __name__ == "__main__":
    main()
