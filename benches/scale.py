"""Time against the number of designs, beside the programs that an engineer would write; see benches/scale.

Every run is a process of its own with a time limit. Counts, fronts and files are compared wherever two methods judge the same designs: a
disagreement is shown, and ends the run with exit code 1.
"""
import argparse
import json
import math
import os
import platform
import subprocess
import sys
import tempfile
import time
from datetime import date
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
import measures  # noqa: E402
import metal_grid  # noqa: E402
import refined  # noqa: E402
from peak import largest_memory, peak_of  # noqa: E402

# Levels of the four continuous axes of metal-grid: 1e7, 1e8, ... 1e12 designs.
LEVELS = (31, 56, 98, 174, 309, 560)
PEERS = {"numpy + moocore": metal_grid.with_numpy, "numba + moocore": metal_grid.with_numba,
         "numba, filtered + moocore": metal_grid.with_numba_filtered}
OWN = {"every design, processor": ("cpu", "exhaustive"), "every design, lavapipe": ("gpu", "exhaustive"), "bounds": ("cpu", "bounds")}
# The largest grid of each, in levels, and why not more; `long` is that of --long.
LARGEST = {
    "numpy + moocore": (98, 98, "an hour and more"),
    "numba + moocore": (98, 98, "moocore sorts half of the designs: as long as numpy"),
    "numba, filtered + moocore": (174, 560, "ten minutes and more; `--long` runs it"),
    "every design, processor": (560, 560, "nothing"),
    "every design, lavapipe": (98, 98, "a software device shows that answers agree, not how fast one is"),
    "bounds": (560, 560, "nothing"),
}
# Levels of groove angle, thickness and traction: all levels of the shipped study (61, 41, 11) are among them.
CVT_LEVELS = ((61, 41, 11), (121, 81, 21), (481, 321, 81), (2101, 1401, 381))
# Of axial_force_N, stress_margin and slip_margin: without them the front of four objectives would grow as the grid does.
RESOLUTIONS = [100, 0.01, 0.01]
BEFORE, AFTER = "<!-- results/bench/scale.md -->\n", "<!-- end of results/bench/scale.md -->\n"


def peer(name, levels, file):
    """Run in a separate process: one other program on one grid. Its clock starts when it is loaded and compiled."""
    PEERS[name](metal_grid.axes(6))
    axes = metal_grid.axes(levels)
    start = time.perf_counter()
    count, best = PEERS[name](axes)
    seconds = time.perf_counter() - start
    np.save(file, best)
    print(json.dumps({"seconds": seconds, "feasible": count, "front": len(best),
                      "peak_MB": largest_memory("self")}))


def run_peer(name, levels, folder, limit):
    file = folder / "peer.npy"
    command = [sys.executable, __file__, "--peer", name, str(levels), str(file)]
    # The time limit is that of the work: loading and compiling come on top.
    try:
        told = subprocess.run(command, check=True, stdout=subprocess.PIPE, timeout=limit + 30).stdout
    except subprocess.TimeoutExpired:
        return {"stopped_after": limit}, None
    except subprocess.CalledProcessError as error:
        return {"failed": f"exit code {error.returncode}"}, None
    best = np.load(file)
    values = np.column_stack([-best[:, 0], best[:, 1]])
    return json.loads(told), values[np.lexsort((values[:, 1], values[:, 0]))]


def run_own(program, study, engine, method, out, limit):
    """Sweeps a study; what it found, and its time and memory as a whole command."""
    command = [program, "sweep", study, "--engine", engine, "--method", method, "--out", out, "--quiet", "--force", "--no-report"]
    start = time.perf_counter()
    process = subprocess.Popen(command)
    peak = peak_of(process, limit)
    seconds = time.perf_counter() - start
    if peak is None:
        return {"stopped_after": limit}
    if process.returncode:
        return {"failed": f"exit code {process.returncode}"}
    summary, run = (json.loads((out / name).read_text()) for name in ("summary.json", "run.json"))
    row = {"seconds": seconds, "feasible": summary["feasible"], "front": summary["front"], "peak_MB": peak, "program": run["program"]}
    if run.get("certificate"):
        row["certificate"] = run["certificate"]
    if run.get("device"):
        row["adapter"], row["driver"] = run["device"]["adapter"], run["device"]["driver"]
    return row


def differences(first, second):
    """Names of the files in which two result directories differ, except for run.json, which describes the run and not the result."""
    names = sorted({file.name for folder in (first, second) for file in folder.iterdir()} - {"run.json"})
    read = [[(folder / name).read_bytes() if (folder / name).exists() else None for name in names] for folder in (first, second)]
    return [name for name, one, other in zip(names, *read) if one != other]


def compare(designs, rows, fronts, folders, problems):
    """All methods must have the same result on a grid: front values of other programs within 1e-9, our files to the byte."""
    done = {name: row for name, row in rows.items() if "seconds" in row}
    problems += [f"{designs} designs: {name} failed: {row['failed']}" for name, row in rows.items() if "failed" in row]
    found = {(row["feasible"], row["front"]) for row in done.values()}
    if len(found) > 1:
        problems.append(f"{designs} designs: feasible and front differ: " + ", ".join(f"{name} {row['feasible']} {row['front']}" for name, row in done.items()))
    (first, reference), *others = folders.items() or [(None, None)]
    for name, out in others:
        for file in differences(reference, out):
            problems.append(f"{designs} designs: {file} differs between {first} and {name}")
    worst = 0.0
    if reference is not None and fronts:
        ours = measures.front_of(reference)
        for name, theirs in fronts.items():
            if ours.shape == theirs.shape:
                worst = max(worst, float(np.max(np.abs(theirs / ours - 1))))
        if worst > 1e-9:
            problems.append(f"{designs} designs: front values differ by {worst:.1e}")
    return worst


def known_elsewhere(designs):
    """Committed records of metal-grid with this many designs, judged one by one on a device."""
    for name in ("device-1e11.json", "gpu-h200.json"):
        file = Path("results/bench", name)
        if not file.exists():
            say(f"{file} is not there: nothing to compare with")
            continue
        record = json.loads(file.read_text())
        if "judged" in record:
            say(f"{file} counts otherwise and is not compared: {record['judged']}")
            continue
        for row in record.get("runs", [record]):
            if row["command"].startswith("beltspace sweep metal-grid") and row["run"]["engine"] == "gpu" and row["run"]["designs"] == designs:
                yield name, row


def grid(program, levels, long, limit, folder, problems):
    """metal-grid with this many levels, by every method that can."""
    designs = 11 * levels**4
    study = folder / f"metal-grid-{levels}.toml"
    study.write_text(refined.grid(levels))
    rows, fronts, folders = {}, {}, {}
    for name in (*PEERS, *OWN):
        largest = LARGEST[name][1 if long else 0]
        if levels > largest:
            continue
        say(f"{name}: {designs:.3g} designs")
        if name in PEERS:
            rows[name], front = run_peer(name, levels, folder, 3600 if long else limit)
            if front is not None:
                fronts[name] = front
        else:
            out = folder / f"{levels}-{'-'.join(OWN[name])}"
            rows[name] = run_own(program, study, *OWN[name], out, limit)
            if "seconds" in rows[name]:
                folders[name] = out
        if "seconds" in rows[name]:
            rows[name]["designs_per_second"] = designs / rows[name]["seconds"]
    if "seconds" in rows["bounds"]:
        for record, known in known_elsewhere(designs):
            if any(known[key] != rows["bounds"][key] for key in ("feasible", "front")):
                problems.append(f"{designs} designs: bounds find {rows['bounds']['feasible']} and {rows['bounds']['front']}, {record} says "
                                f"{known['feasible']} and {known['front']}")
    worst = compare(designs, rows, fronts, folders, problems)
    return {"levels": levels, "designs": designs, "largest_difference": worst, "methods": rows}


def cvt(program, levels, resolutions, limit, folder, problems):
    """metal-cvt, finer, by bounds; up to 1e9 designs also design by design."""
    study = folder / f"metal-cvt-{levels[0]}.toml"
    study.write_text(refined.cvt(resolutions, *levels))
    designs = 9 * math.prod(levels)
    rows, folders = {}, {}
    for name in ("every design, processor", "bounds"):
        if name != "bounds" and designs > 1e9:
            continue
        say(f"metal-cvt, {name}: {designs:.3g} designs x 434 scenarios")
        out = folder / f"cvt-{levels[0]}-{OWN[name][1]}"
        rows[name] = run_own(program, study, *OWN[name], out, limit)
        if "seconds" in rows[name]:
            folders[name] = out
            rows[name]["designs_per_second"] = designs / rows[name]["seconds"]
    compare(designs, rows, {}, folders, problems)
    return {"levels": levels, "designs": designs, "scenarios": 434, "methods": rows}


def exponent(points):
    """Slope of log y against log x, by least squares; None of fewer than two points."""
    points = [(x, y) for x, y in points if y]
    if len(points) < 2:
        return None
    return float(np.polyfit(*np.log(np.array(points, dtype=float)).T, 1)[0])


def fits(studies):
    """Fitted exponents against designs: time per method, and the work of bounds. `last` is the exponent of the two largest sizes alone."""
    found = {}
    for name in dict.fromkeys(name for study in studies for name in study["methods"]):
        done = [(study["designs"], study["methods"][name]) for study in studies if "seconds" in study["methods"].get(name, {})]
        quantities = {"time": [(designs, row["seconds"]) for designs, row in done]}
        if name == "bounds":
            for what in ("boxes", "evaluations"):
                quantities[what] = [(designs, row["certificate"][what]) for designs, row in done]
            quantities["front"] = [(designs, row["front"]) for designs, row in done]
        found[name] = {what: {"all": exponent(points), "last": exponent(points[-2:])} for what, points in quantities.items()}
    return found


def settled(rules):
    """Fractions of designs by the rule that settled them, in one section of a certificate, largest first."""
    shares = sorted(((count / rules["designs"], rule) for rule, count in rules.items() if rule.startswith(("in_", "judged_")) and count), reverse=True)
    return {rule: share for share, rule in shares}


def aligned(rows):
    """A Markdown table whose columns are aligned as plain text too; the first column to the left."""
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    lines = ["| " + " | ".join(cell.rjust(width) if at else cell.ljust(width) for at, (cell, width) in enumerate(zip(row, widths))) + " |" for row in rows]
    rule = "|" + "|".join("-" * (width + 1) + (":" if at else "-") for at, width in enumerate(widths)) + "|"
    return [lines[0], rule, *lines[1:]]


def seconds_of(seconds):
    return f"{seconds:.2f} s" if seconds < 100 else f"{seconds:.0f} s"


def cell(row, designs):
    if row is None:
        return ""
    if "seconds" not in row:
        return f"> {row['stopped_after']:.0f} s" if "stopped_after" in row else row["failed"]
    return f"{seconds_of(row['seconds'])}, {row['designs_per_second']:.1e}/s"


def two_places(value):
    return "" if value is None else f"{value:.2f}"


def table_of_times(studies, fitted):
    header = ["designs"] + [f"{study['designs']:.2e}" for study in studies] + ["exponent", "of the last two"]
    rows = [header]
    for name in dict.fromkeys(name for study in studies for name in study["methods"]):
        time_fit = fitted[name]["time"]
        rows.append([name] + [cell(study["methods"].get(name), study["designs"]) for study in studies] + [two_places(time_fit["all"]), two_places(time_fit["last"])])
    return aligned(rows)


def table_of_bounds(studies, fitted):
    rows = [["bounds", "feasible", "front", "boxes", "evaluations", "peak memory"]]
    for study in studies:
        row = study["methods"]["bounds"]
        if "seconds" in row:
            certificate = row["certificate"]
            rows.append([f"{study['designs']} designs", str(row["feasible"]), str(row["front"]), str(certificate["boxes"]),
                         str(certificate["evaluations"]), f"{row['peak_MB']:.0f} MB"])
    for which, name in (("all", "exponent"), ("last", "of the last two")):
        rows.append([name, ""] + [two_places(fitted["bounds"][what][which]) for what in ("front", "boxes", "evaluations")] + [""])
    return aligned(rows)


def words_of_rules(study):
    """How the largest study that bounds ended settled its designs, in words."""
    certificate = study["methods"]["bounds"]["certificate"]
    parts = [("count", certificate["count"])] + [(f"search for {it['for']}", it) for it in certificate["searches"] if it["for"] == "front"]
    return "; ".join(f"{name}: " + ", ".join(f"{100 * share:.3g} % {rule.replace('_', ' ')}" for rule, share in settled(part).items()) for name, part in parts)


def left_out(record):
    """Which methods did not run on the largest grids, why, and how long they would take at their own rate."""
    lines, largest = [], record["grid"][-1]["designs"]
    for name, (usual, long, why) in LARGEST.items():
        done = [(study["designs"], study["methods"][name]) for study in record["grid"] if "seconds" in study["methods"].get(name, {})]
        # Bounds have no rate for an estimate; where they were stopped, that is said separately.
        if not done or done[-1][0] == largest or name == "bounds":
            continue
        if any("stopped_after" in study["methods"].get(name, {}) for study in record["grid"]):
            why = "the time limit ended more"
        designs, row = done[-1]
        guess = row["seconds"] * largest / designs
        lines.append(f"- {name}: no more than {designs:.2e} designs ({why}). At the rate that it had there, {largest:.2e} would take "
                     f"{guess:.2g} s; this is extrapolated, not measured.")
    return lines


def cvt_page(record):
    force, stress, slip = record["resolutions"]
    lines = [f"`metal-cvt`, refined, each design in 434 scenarios, without histograms and maps; a front of four "
             f"objectives in steps of {force:g} N, {stress:g} and {slip:g} (stress and slip margin):", ""]
    lines += table_of_times(record["cvt"], record["fits"]["cvt"]) + [""]
    lines += table_of_bounds(record["cvt"], record["fits"]["cvt"]) + [""]
    ended = [study for study in record["cvt"] if "seconds" in study["methods"]["bounds"]]
    if ended:
        lines += [f"What settled the {ended[-1]['designs']:.2e} designs: {words_of_rules(ended[-1])}.", ""]
    return lines


def page(record):
    """The text that is printed and written to results/bench/scale.md and docs/manual/measured.md."""
    lines = [f"{record['machine']}, {record['cores']} cores, {record['memory_GB']:.0f} GB, {record['date']}; {', '.join(record['versions'])}.", "",
             "`metal-grid`, finer and finer: wall time and designs per second, and the exponent of time against designs, fitted to all sizes "
             "and between the two largest:", ""]
    lines += table_of_times(record["grid"], record["fits"]["grid"]) + [""]
    lines += table_of_bounds(record["grid"], record["fits"]["grid"]) + [""]
    ended = [study for study in record["grid"] if "seconds" in study["methods"]["bounds"]]
    if ended:
        lines += [f"What settled the {ended[-1]['designs']:.2e} designs: {words_of_rules(ended[-1])}.", ""]
    if record["cvt"]:
        lines += cvt_page(record)
    lines += [f"Where methods meet, counts and fronts are the same, our files to the byte, values of the others within "
              f"{max(study['largest_difference'] for study in record['grid']):.0e}." if not record["problems"] else "METHODS DISAGREE:"]
    lines += [f"- {it}" for it in record["problems"]] + [""]
    stopped = [f"- {name}, {study['designs']:.2e} designs{' of metal-cvt' if 'scenarios' in study else ''}: stopped at the time limit of {row['stopped_after']:.0f} s"
               for study in record["grid"] + record["cvt"] for name, row in study["methods"].items() if "stopped_after" in row]
    missing = left_out(record) + stopped
    return "\n".join(lines + (["What was left out:", ""] + missing if missing else [])).rstrip() + "\n"


def say(text):
    """Progress, for a run of many minutes; not part of the result."""
    print(f"[{time.strftime('%H:%M:%S')}] {text}", file=sys.stderr, flush=True)


def version_of(command):
    try:
        return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return f"{command[0]} unknown"


def versions(record):
    import moocore
    import numba

    rows = [row for study in record["grid"] + record["cvt"] for row in study["methods"].values()]
    own = {row["program"] for row in rows if "program" in row} | {row["driver"] for row in rows if "driver" in row}
    return [*sorted(own), version_of(["rustc", "-V"]).split(" (")[0], f"Python {platform.python_version()}", f"numpy {np.__version__}",
            f"numba {numba.__version__}", f"moocore {moocore.__version__}"]


def conclude(record):
    record["fits"] = {name: fits(record[name]) for name in ("grid", "cvt")}
    record["versions"] = versions(record)
    return record


def write(record, out, docs):
    text = page(record)
    out.mkdir(parents=True, exist_ok=True)
    (out / "scale.json").write_text(json.dumps(record, indent=2) + "\n")
    (out / "scale.md").write_text(text)
    if docs:
        file = Path("docs/manual/measured.md")
        before, rest = file.read_text().split(BEFORE)
        file.write_text(before + BEFORE + text + AFTER + rest.split(AFTER)[1])
    return text


def main():
    arguments = argparse.ArgumentParser(prog="benches/scale")
    arguments.add_argument("program", help=argparse.SUPPRESS)
    arguments.add_argument("--out", type=Path, help="folder for scale.json and scale.md [default: results/bench; with --short a temporary one]")
    arguments.add_argument("--short", action="store_true", help="small sizes only: do all methods agree?")
    arguments.add_argument("--long", action="store_true", help="numba to 1e12 designs too")
    arguments.add_argument("--limit", type=float, default=600, metavar="SECONDS", help="time limit of each run [default: 600]")
    arguments.add_argument("--resolutions", type=lambda text: [float(it) for it in text.split(",")], default=RESOLUTIONS, metavar="N,STRESS,SLIP",
                           help="of the refined metal-cvt's axial force and margins [default: 100,0.01,0.01, a front of 1700 points; "
                                "25,0.0025,0.0025 gives more than 16000]")
    arguments.add_argument("--docs", action="store_true", help="put the page into docs/manual/measured.md too")
    arguments.add_argument("--render", action="store_true", help="run nothing: write the pages again from scale.json")
    given = arguments.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        out = given.out or (folder if given.short else Path("results/bench"))
        if given.render:
            record = json.loads((out / "scale.json").read_text())
            return print(write(record, out, given.docs), end="")
        problems = []
        run_own(given.program, write_study(folder), "cpu", "exhaustive", folder / "warm", 60)  # the program's pages are read before the clock counts
        record = {"date": date.today().isoformat(), "machine": measures.processor(), "cores": os.cpu_count(),
                  "memory_GB": os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 1e9,
                  "command": "benches/scale" + "".join(f" --{name}" for name in ("short", "long") if getattr(given, name)),
                  "limit_seconds": given.limit, "resolutions": given.resolutions}
        record["grid"], record["cvt"], record["problems"] = [], [], problems
        # Written after each size: a run of half an hour that is stopped leaves what it has.
        for levels in (16, 31) if given.short else LEVELS:
            record["grid"].append(grid(given.program, levels, given.long, given.limit, folder, problems))
            write(conclude(record), out, False)
        for levels in CVT_LEVELS[:1] if given.short else CVT_LEVELS:
            record["cvt"].append(cvt(given.program, levels, given.resolutions, given.limit, folder, problems))
            write(conclude(record), out, False)
        print(write(record, out, given.docs), end="")
    if problems:
        sys.exit("methods disagree")


def write_study(folder):
    study = folder / "small.toml"
    study.write_text(refined.grid(10))
    return study


if __name__ == "__main__":
    if sys.argv[1:2] == ["--peer"]:
        peer(sys.argv[2], int(sys.argv[3]), sys.argv[4])
    else:
        main()
