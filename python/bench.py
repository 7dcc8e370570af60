"""How fast models and studies are evaluated from Python, beside numpy on the same formulas (bench_numpy.py) in the same run.

Usage: bench.py [--short] [--out FILE.json]; --short takes fewer rows and only says what it finds. Values are compared, too.
"""

import argparse
import json
import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import bench_numpy
import numpy as np

import beltspace

ROOT = Path(__file__).resolve().parent.parent
OUTPUTS = ["torque_capacity_Nm", "capacity_axial_force_N"]
# Rows whose columns stay in numpy's caches.
BLOCK = 8192


def in_blocks(rows: dict[str, np.ndarray], asked: list[str] | None) -> None:
    """The same in blocks of rows, as somebody would write it who knows how numpy uses the caches."""
    for first in range(0, len(rows["ratio"]), BLOCK):
        bench_numpy.evaluate({name: column[first : first + BLOCK] for name, column in rows.items()}, asked)


def compare(found: beltspace.Table, theirs: dict[str, np.ndarray]) -> float:
    """The largest relative difference; statuses, and which values are absent, must be the same."""
    assert np.array_equal(np.array(bench_numpy.STATUSES)[theirs["status"]], found["status"].astype(str)), "other statuses"
    apart = 0.0
    for name in found.column_names[:-1]:
        ours, numbers = found[name], theirs[name]
        assert np.array_equal(np.isnan(ours), np.isnan(numbers)), f"{name}: other rows have no value"
        # Differences of numbers that nearly cancel are compared with what they are differences of.
        floor = {"stress_margin": 1.0, "entry_compression": 1.0}.get(name, max(1e-3 * np.nanmax(np.abs(ours)), 1e-300))
        apart = max(apart, float(np.nanmax(np.abs(ours - numbers) / np.maximum(np.abs(ours), floor), initial=0.0)))
    return apart


def best(work: Callable[[], Any], times: int) -> tuple[float, float, Any]:
    """The shortest time in s and the least processor time, of all threads together, and what came out."""
    took = []
    for _ in range(times):
        start, of_processor = time.perf_counter(), time.process_time()
        found = work()
        took.append((time.perf_counter() - start, time.process_time() - of_processor))
    return min(it[0] for it in took), min(it[1] for it in took), found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--short", action="store_true")
    parser.add_argument("--out", type=Path)
    request = parser.parse_args()
    count, times = (200_000, 2) if request.short else (1_000_000, 5)
    random = np.random.default_rng(1)
    rows = {
        "friction": random.uniform(0.06, 0.12, count),
        "groove_angle_deg": random.uniform(18, 30, count),
        "ratio": random.uniform(0.5, 2, count),
        "band_thickness_mm": random.uniform(0.1, 0.4, count),
        "band_count": random.integers(4, 15, count).astype(float),
    }
    # In a hundredth of the rows the wedge would need no axial force.
    rows["friction"][::100] = 6.5
    own: dict[str, Any] = rows | {"traction": "limit"}
    # Each beside numpy with the same outputs, absent where they have no meaning, and the same statuses.
    beside = {}
    for what, asked in (("two_outputs", OUTPUTS), ("all_outputs", None)):
        ours, our_work, found = best(lambda asked=asked: beltspace.evaluate("metal-cvt", own, outputs=asked), times)  # type: ignore[misc]
        theirs, their_work, wanted = best(lambda asked=asked: bench_numpy.evaluate(rows, asked), times)  # type: ignore[misc]
        blocks, blocks_work, _ = best(lambda asked=asked: in_blocks(rows, asked), times)  # type: ignore[misc]
        apart = compare(found, wanted)
        assert apart < 1e-8, f"numpy's values are {apart:.1e} apart"
        assert np.mean(found["status"] == "ok") == 0.99, "some checks fail, and most hold"
        beside[what] = {
            "outputs": found.num_columns - 1,
            "rows_per_s": round(count / ours),
            "numpy_rows_per_s": round(count / theirs),
            "numpy_in_blocks_rows_per_s": round(count / blocks),
            "times_numpy": round(theirs / ours, 2),
            "times_numpy_in_blocks": round(blocks / ours, 2),
            # Of all threads together, which other work on the machine does not change.
            "processor_ns_per_row": round(1e9 * our_work / count, 1),
            "numpy_processor_ns_per_row": round(1e9 * their_work / count, 1),
            "numpy_in_blocks_processor_ns_per_row": round(1e9 * blocks_work / count, 1),
            "largest_difference_to_numpy": apart,
        }

    study = beltspace.Study.from_file(ROOT / "studies" / "metal-cvt.toml")
    designs = 1_000 if request.short else 10_000
    table = {
        "groove_angle_deg": random.uniform(18, 30, designs),
        "band_thickness_mm": random.uniform(0.1, 0.3, designs),
        "band_count": random.integers(6, 15, designs),
        "reserve": random.uniform(1.3, 1.8, designs),
    }
    worst, worst_work, _ = best(lambda: study.worst(table), 2 if request.short else 5)
    by_traction = beltspace.Study.from_file(ROOT / "benches" / "studies" / "metal-cvt-traction.toml")
    of_traction = {name: table[name] for name in by_traction.design if name in table} | {"traction": random.uniform(0.3, 0.5, designs)}
    worst_by_traction, by_traction_work, _ = best(lambda: by_traction.worst(of_traction), 2 if request.short else 5)
    levels = {name: column[random.integers(0, 8, designs)] for name, column in table.items() if name != "band_count"}
    on_levels, _, _ = best(lambda: study.worst(levels | {"band_count": table["band_count"]}), 2)
    told = {
        "cores": os.cpu_count(),
        "rows": count,
        **beside,
        "worst_designs": designs,
        "worst_scenarios": study.scenarios,
        "worst_s": round(worst, 4),
        "worst_on_levels_s": round(on_levels, 4),
        "worst_processor_s": round(worst_work, 4),
        "worst_by_traction_s": round(worst_by_traction, 4),
        "worst_by_traction_processor_s": round(by_traction_work, 4),
    }
    print(json.dumps(told, indent=2))
    if request.out:
        request.out.write_text(json.dumps(told, indent=2) + "\n")


main()
