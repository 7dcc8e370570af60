"""Times studies with formulas: from text to result, and a model in a file against the same model of the program, on the CPU and, with
`--device`, on a device (lavapipe, which takes processor time, unless there is another)."""

import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

PROGRAM = Path("target/release/beltspace").resolve()
MODELS = Path("tests/it/formulas/models")
RUNS = 5

EDITED = """
model = "metal-cvt"
title = "Ten million belts"
units = ["EUR"]
[design]
band_thickness_mm      = { from = 0.10, to = 0.30, count = 161 }
band_count             = { from = 4, to = 14 }
groove_angle_deg       = { from = 18, to = 30, count = 141 }
steel_price_EUR_per_kg = { from = 10, to = 16, count = 41 }
[operation]
ratio     = [0.6, 1, 1.7]
torque_Nm = [50, 150]
[fixed]
strength_MPa = 600
[formulas]
belt_mass_kg = "2 * band_count * band_width_mm * band_thickness_mm * belt_length_mm * 7850[kg/m^3]"
cost_EUR     = "steel_price_EUR_per_kg * belt_mass_kg + 0.8[EUR] * band_count"
[constraints]
stress_margin = { min = 0 }
[objectives]
cost_EUR      = "min"
axial_force_N = "min"
"""

WRITTEN_AGAIN = {
    "metal-cvt": """
[design]
groove_angle_deg  = { from = 18, to = 30, count = 9 }
band_thickness_mm = { from = 0.10, to = 0.30, count = 401 }
band_count        = { from = 4, to = 14 }
[operation]
ratio     = { from = 0.5, to = 2.0, count = 13, spacing = "log" }
torque_Nm = [50, 100, 150]
[objectives]
axial_force_N = "min"
stress_margin = "max"
""",
    "rubber-cvt": """
[design]
groove_angle_deg  = { from = 24, to = 34, count = 11 }
belt_width_mm     = { from = 20, to = 50, count = 61 }
belt_thickness_mm = { from = 1, to = 3, count = 81 }
[operation]
ratio     = { from = 0.5, to = 2.0, count = 13, spacing = "log" }
torque_Nm = [8, 10, 12]
[objectives]
axial_force_N = "min"
stress_margin = "max"
""",
    "pulley-load": """
[design]
mean_radius_mm   = { from = 40, to = 80, count = 81 }
slack_tension_N  = { from = 300, to = 900, count = 121 }
groove_angle_deg = { from = 34, to = 38, count = 9 }
[operation]
power_kW = [1, 2, 3]
speed_rpm = [1000, 3000, 5000]
[objectives]
resultant_force_N = "min"
friction_margin   = "max"
""",
}


def best(folder, study, engine="cpu", runs=RUNS):
    """Seconds of the clock and of the processor, each the best of some runs of a sweep in a folder."""
    clock, used = [], []
    for run in range(runs):
        out = folder / f"out-{run}"
        before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
        words = [PROGRAM, "sweep", study, "--out", out, "--quiet", "--engine", engine]
        subprocess.run(words, cwd=folder, check=True, stderr=subprocess.DEVNULL)
        clock.append(time.perf_counter() - start)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        used.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
        shutil.rmtree(out)
    return min(clock), min(used)


# On a device: of each model a study with few survivors, so that what the CPU does of them counts little, and two numbers of levels.
ON_DEVICE = {
    "metal-cvt": ("""
[design]
groove_angle_deg  = {{ from = 18, to = 30, count = {levels} }}
band_thickness_mm = {{ from = 0.10, to = 0.30, count = 1601 }}
band_count        = {{ from = 4, to = 14 }}
[operation]
ratio     = {{ from = 0.5, to = 2.0, count = 13, spacing = "log" }}
torque_Nm = [50, 100, 150]
[fixed]
strength_MPa = 900
[constraints]
stress_margin = {{ min = 0.05 }}
[objectives]
axial_force_N = "min"
""", (64, 384)),
    "rubber-cvt": ("""
[design]
groove_angle_deg  = {{ from = 24, to = 34, count = {levels} }}
belt_width_mm     = {{ from = 20, to = 50, count = 181 }}
belt_thickness_mm = {{ from = 1, to = 3, count = 81 }}
[operation]
ratio     = {{ from = 0.5, to = 2.0, count = 13, spacing = "log" }}
torque_Nm = [8, 10, 12]
[constraints]
stress_margin = {{ min = 0.05 }}
[objectives]
axial_force_N = "min"
""", (64, 512)),
    "pulley-load": ("""
[design]
mean_radius_mm   = {{ from = 40, to = 80, count = 241 }}
slack_tension_N  = {{ from = 300, to = 900, count = 361 }}
groove_angle_deg = {{ from = 34, to = 38, count = {levels} }}
[operation]
power_kW  = [1, 2, 3]
speed_rpm = [1000, 3000, 5000]
[constraints]
friction_margin = {{ min = 0.05 }}
[objectives]
resultant_force_N = "min"
""", (20, 100)),
}


def on_device(folder):
    """Processor seconds of the larger study less those of the smaller one, so that start and end do not count, for both ways to write a model."""
    for model, (study, levels) in ON_DEVICE.items():
        names = (model, f"{model}-in-a-file.toml")
        used = {}
        # In turn, so that what else the machine does falls on both.
        for _ in range(RUNS):
            for name in names:
                for count in levels:
                    (folder / "study.toml").write_text(f'model = "{name}"\n{study.format(levels=count)}')
                    seconds = best(folder, "study.toml", "gpu", runs=1)[1]
                    used[name, count] = min(seconds, used.get((name, count), seconds))
        own, written = (used[name, levels[1]] - used[name, levels[0]] for name in names)
        begin = [used[name, levels[0]] for name in names]
        print(f"{model} on a device: processor {own:.2f} s, written as a file {written:.2f} s, ratio {written / own:.2f}; "
              f"the smaller study as a whole {begin[0]:.2f} s and {begin[1]:.2f} s")


def main():
    folder = Path(tempfile.mkdtemp())
    try:
        (folder / "edited.toml").write_text(EDITED)
        six, used_six = best(folder, "edited.toml")
        head, rest = EDITED.split("[operation]")
        (folder / "edited.toml").write_text(head + "[fixed]\ntorque_Nm = 150" + rest.split("[fixed]")[1])
        clock, used = best(folder, "edited.toml")
        designs = 161 * 11 * 141 * 41
        print(f"from text to result, page included: {designs} designs, two formulas: {clock:.3f} s, processor {used:.3f} s; "
              f"in 6 scenarios each: {six:.3f} s, processor {used_six:.3f} s")
        limit = [float(word) for word in sys.argv[1:] if word != "--device"]
        if limit and clock > limit[0]:
            sys.exit(f"that is more than {limit[0]} s")
        for file in MODELS.glob("*-in-a-file.toml"):
            shutil.copy(file, folder)
        for model, study in WRITTEN_AGAIN.items():
            times = []
            for name in (model, f"{model}-in-a-file.toml"):
                (folder / "study.toml").write_text(f'model = "{name}"\n{study}')
                times.append(best(folder, "study.toml")[1])
            print(f"{model}: processor {times[0]:.3f} s, written as a file {times[1]:.3f} s, ratio {times[1] / times[0]:.2f}")
        if "--device" in sys.argv:
            on_device(folder)
    finally:
        shutil.rmtree(folder)


if __name__ == "__main__":
    main()
