"""What the tests share."""

import contextlib
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

import beltspace

ROOT = Path(__file__).resolve().parents[2]

STUDY = """
model = "metal-cvt"
title = "A small push belt"

[design]
groove_angle_deg = { from = 18, to = 30, count = 13 }
band_thickness_mm = { from = 0.10, to = 0.30, step = 0.02 }
band_count = { from = 6, to = 14 }

[operation]
ratio = { from = 0.5, to = 2.0, count = 7, spacing = "log" }
torque_Nm = [40, 100]

[constraints]
stress_margin = { min = 0 }

[objectives]
axial_force_upper_N = "min"
stress_margin = "max"

[report]
columns = ["max_stress_MPa"]
top = { by = "axial_force_upper_N", count = 20 }
sample = 50
feasible = true
histograms = [{ of = "axial_force_upper_N", from = 0, to = 120000, bins = 60 }]
maps = [{ x = "band_thickness_mm", y = "groove_angle_deg", value = "axial_force_upper_N" }]
"""


@contextlib.contextmanager
def another_thread() -> Iterator[list[int]]:
    """Another thread of Python, which counts every ms as long as it may run."""
    counted, ended = [0], threading.Event()

    def count() -> None:
        while not ended.is_set():
            counted[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    try:
        yield counted
    finally:
        ended.set()
        thread.join()


@pytest.fixture(scope="session")
def study() -> beltspace.Study:
    return beltspace.Study.from_toml(STUDY)


@pytest.fixture(scope="session")
def result(study: beltspace.Study) -> beltspace.Result:
    return study.sweep()


@pytest.fixture(scope="session")
def root() -> Path:
    return ROOT
