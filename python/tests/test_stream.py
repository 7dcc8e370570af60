"""Feasible designs as a stream: the same rows as in one table, again and again, without more memory than a few blocks take."""

import os
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import beltspace

BLOCK = 65_536

# 800 000 designs, nearly all of them feasible: their rows take more than 50 MB in memory.
LONG = """
model = "flat-belt"
[design]
belt_width_mm = { from = 80, to = 400, count = 800 }
tension_per_width_N_per_mm = { from = 8, to = 30, count = 1000 }
[operation]
power_kW = [10]
[objectives]
belt_width_mm = "min"
slip_margin = "max"
[report]
feasible = true
"""


@pytest.fixture(scope="module")
def long() -> beltspace.RowStream:
    feasible = beltspace.Study.from_toml(LONG).sweep().feasible
    assert feasible is not None
    return feasible


def test_blocks_are_the_rows_in_order(result: beltspace.Result) -> None:
    rows = result.feasible
    assert rows is not None and rows.num_rows == len(rows) == result.feasible_designs
    whole = rows.to_table()
    assert rows.column_names == whole.column_names and rows.num_columns == whole.num_columns
    for _ in range(2):
        index = np.concatenate([table["design_index"] for table in rows])
        assert index.tobytes() == whole["design_index"].tobytes() and (np.diff(index.astype(np.int64)) > 0).all()
    assert len(rows.to_pandas()) == len(rows)


def test_arrow_asks_again_and_again(long: beltspace.RowStream) -> None:
    pyarrow = pytest.importorskip("pyarrow")
    assert long.num_rows > 4 * BLOCK
    reader = pyarrow.RecordBatchReader.from_stream(long)
    assert reader.schema.names == long.column_names == pyarrow.schema(long).names
    sizes = [len(batch) for batch in reader]
    assert sum(sizes) == long.num_rows and set(sizes[:-1]) == {BLOCK}
    # What was begun and left does not move the next reader on.
    first = next(iter(pyarrow.RecordBatchReader.from_stream(long)))
    again = next(iter(pyarrow.RecordBatchReader.from_stream(long)))
    assert first.equals(again) and first["design_index"][0].as_py() == next(iter(long))["design_index"][0]


def test_nothing_feasible_is_a_stream_with_columns() -> None:
    pyarrow = pytest.importorskip("pyarrow")
    none = beltspace.Study.from_toml(LONG.replace("[objectives]", "[constraints]\nslip_margin = { min = 1e6 }\n[objectives]")).sweep()
    assert none.feasible is not None and len(none.feasible) == 0 and list(none.feasible) == []
    assert pyarrow.table(none.feasible).column_names == none.feasible.column_names
    assert beltspace.Study.from_toml(LONG.replace("feasible = true", "")).sweep().feasible is None


class Watch(threading.Thread):
    """The largest resident memory while it runs, in bytes."""

    def __init__(self) -> None:
        super().__init__()
        self.most, self.ended = 0, threading.Event()

    def run(self) -> None:
        while not self.ended.is_set():
            pages = int(Path("/proc/self/statm").read_text().split()[1])
            self.most = max(self.most, pages * os.sysconf("SC_PAGE_SIZE"))
            time.sleep(0.005)

    def __enter__(self) -> "Watch":
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.ended.set()
        self.join()


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="resident memory is read from /proc")
def test_reading_takes_the_memory_of_a_few_blocks(long: beltspace.RowStream) -> None:
    def read(tables: int) -> tuple[int, int]:
        rows = 0
        with Watch() as watch:
            for table, _ in zip(long, range(tables), strict=False):
                rows += len(table)
        return watch.most, rows

    read(2)
    few, _ = read(2)
    many, rows = read(1000)
    assert rows == long.num_rows
    assert many < few + (24 << 20), f"{(many - few) >> 20} MB more for all blocks than for two"
    # The measure sees what is kept: all tables at once take more.
    with Watch() as watch:
        kept = list(long)
    assert len(kept) > 4 and watch.most > few + (24 << 20)
