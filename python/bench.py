"""How fast models and studies are evaluated from Python, beside numpy on the same formulas in the same run.

Usage: bench.py [--short] [--out FILE.json]; --short takes fewer rows and only says what it finds. Values are compared, too.
"""

import argparse
import json
import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import beltspace

ROOT = Path(__file__).resolve().parent.parent
WIDTH, MODULUS, STRENGTH, CENTRE, LENGTH = 9.0, 2.1e5, 500.0, 156.0, 613.0
FREE = LENGTH / (2 * np.pi)
OUTPUTS = ["torque_capacity_Nm", "capacity_axial_force_N"]


def radius(ratio: np.ndarray) -> np.ndarray:
    """Pitch radius of the driver in mm, by Newton's steps from above, as many as f64 needs."""
    r = (LENGTH - 2 * CENTRE) / (np.pi * (1 + ratio))
    step = ratio - 1
    for _ in range(6):
        sine = step * r / CENTRE
        lean = np.arcsin(sine)
        slope = np.pi * (1 + ratio) + 2 * lean * step
        r = r - (2 * CENTRE * np.sqrt(1 - sine * sine) + np.pi * (1 + ratio) * r + 2 * lean * step * r - LENGTH) / slope
    return r


def with_numpy(rows: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Torque capacity in N m and axial force at it in N: the formulas of metal-cvt at the slip limit, with the defaults of the rest."""
    mu, a, ratio = rows["friction"], np.radians(rows["groove_angle_deg"]), rows["ratio"]
    h, n = rows["band_thickness_mm"], rows["band_count"]
    r1 = radius(ratio)
    r2 = ratio * r1
    lean = np.arcsin((r2 - r1) / CENTRE)
    w1, w2 = np.pi - 2 * lean, np.pi + 2 * lean
    s, c = np.sin(a / 2), np.cos(a / 2)
    t = s / c
    lam = np.tanh(mu / s * np.minimum(w1, w2) / 2)
    stress = np.maximum(0.0, STRENGTH - MODULUS * h / 2 * (1 / np.minimum(r1, r2) - 1 / FREE))
    pull = stress * 2 * n * WIDTH * h * 2 * lam / (1 + lam)
    k = (1 - mu * t) / (mu + t)
    driver = (1 + lam) / (4 * lam) * w1 * k * pull
    arc = np.log((1 + lam) / (1 - lam)) * s / mu
    driven = ((1 - lam) / (4 * lam) * (w2 - arc) * k + c / (2 * mu)) * pull
    return pull * r1 / 1000, np.maximum(driver, driven)


def best(work: Callable[[], Any], times: int) -> tuple[float, Any]:
    """The shortest time in s, and what came out."""
    took = []
    for _ in range(times):
        start = time.perf_counter()
        found = work()
        took.append(time.perf_counter() - start)
    return min(took), found


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
    own: dict[str, Any] = rows | {"traction": "limit"}
    ours, found = best(lambda: beltspace.evaluate("metal-cvt", own, outputs=OUTPUTS), times)
    all_outputs, everything = best(lambda: beltspace.evaluate("metal-cvt", own), times)
    theirs, (capacity, force) = best(lambda: with_numpy(rows), times)
    ok = np.isfinite(found[OUTPUTS[0]]) & (capacity > 1e-6)
    apart = max(np.max(np.abs(found[name][ok] / wanted[ok] - 1)) for name, wanted in zip(OUTPUTS, (capacity, force), strict=True))
    assert ok.mean() > 0.5 and apart < 1e-9, f"numpy's values are {apart:.1e} apart, {ok.mean():.0%} compared"

    study = beltspace.Study.from_file(ROOT / "studies" / "metal-cvt.toml")
    designs = 1_000 if request.short else 10_000
    table = {
        "groove_angle_deg": random.uniform(18, 30, designs),
        "band_thickness_mm": random.uniform(0.1, 0.3, designs),
        "band_count": random.integers(6, 15, designs),
        "reserve": random.uniform(1.3, 1.8, designs),
    }
    worst, _ = best(lambda: study.worst(table), 2 if request.short else 5)
    levels = {name: column[random.integers(0, 8, designs)] for name, column in table.items() if name != "band_count"}
    on_levels, _ = best(lambda: study.worst(levels | {"band_count": table["band_count"]}), 2)
    told = {
        "cores": os.cpu_count(),
        "rows": count,
        "evaluate_rows_per_s": round(count / ours),
        "evaluate_all_outputs_rows_per_s": round(count / all_outputs),
        "outputs": everything.num_columns - 1,
        "numpy_rows_per_s": round(count / theirs),
        "times_numpy": round(theirs / ours, 2),
        "largest_difference_to_numpy": float(apart),
        "worst_designs": designs,
        "worst_scenarios": study.scenarios,
        "worst_s": round(worst, 4),
        "worst_on_levels_s": round(on_levels, 4),
    }
    print(json.dumps(told, indent=2))
    if request.out:
        request.out.write_text(json.dumps(told, indent=2) + "\n")


main()
