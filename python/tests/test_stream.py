"""Feasible designs as a stream: the same rows as in one table, again and again, without more memory than a few blocks take."""

import contextlib
import os
import signal
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import beltspace
from conftest import another_thread

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


@contextlib.contextmanager
def ctrl_c_after(seconds: float) -> Iterator[list[float]]:
    """Ctrl-C so many seconds from now; the list gets the time when it came."""
    sent: list[float] = []

    def send() -> None:
        sent.append(time.perf_counter())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(seconds, send)
    timer.start()
    try:
        yield sent
    finally:
        timer.join()


def read_by_pyarrow(rows: beltspace.RowStream) -> None:
    """Reads without beltspace further up: pyarrow's own error comes first, and Ctrl-C once more where Python runs again."""
    pyarrow = pytest.importorskip("pyarrow")
    reader = pyarrow.RecordBatchReader.from_stream(rows)
    try:
        reader.read_all()
    except pyarrow.ArrowInvalid as error:
        assert "the rows were not read to their end: KeyboardInterrupt" in str(error)
        time.sleep(1.0)


READERS = {
    "to_pyarrow": lambda rows: rows.to_pyarrow(),
    "to_polars": lambda rows: rows.to_polars(),
    "to_pandas": lambda rows: rows.to_pandas(),
    "to_table": lambda rows: rows.to_table(),
    "from_stream": read_by_pyarrow,
}


@pytest.fixture(scope="module")
def slow() -> beltspace.RowStream:
    """Rows of which each has many scenarios: all take seconds."""
    loads = "power_kW = { from = 1, to = 10, count = 40 }"
    feasible = beltspace.Study.from_toml(LONG.replace("power_kW = [10]", loads)).sweep().feasible
    assert feasible is not None
    return feasible


@pytest.mark.parametrize("reader", READERS)
def test_ctrl_c_ends_whoever_reads(slow: beltspace.RowStream, reader: str) -> None:
    took = []
    # The least of three: other programs may have the cores for a while.
    while len(took) < 3 and min(took, default=1.0) >= 0.2:
        with ctrl_c_after(0.3) as sent:
            with pytest.raises(KeyboardInterrupt):
                READERS[reader](slow)
            took.append(time.perf_counter() - sent[0])
    assert min(took) < 0.2, f"Ctrl-C took {took} s"


def test_threads_that_are_not_the_main_one_read_too(long: beltspace.RowStream) -> None:
    pyarrow = pytest.importorskip("pyarrow")
    read: list[int] = []
    threads = [threading.Thread(target=lambda: read.append(pyarrow.table(long).num_rows)) for _ in range(2)]
    for thread in threads:
        thread.start()
    read.append(len(long.to_polars()))
    for thread in threads:
        thread.join()
    assert read == [long.num_rows] * 3


def test_who_reads_on_after_ctrl_c_misses_nothing(slow: beltspace.RowStream) -> None:
    # The signal may also come once a table is there and before the next line has it; rarely, so of three times one is without that.
    lost = []
    for _ in range(3):
        tables, indices = iter(slow), []
        for wait in (0.05, 0.1, 0.15):
            with pytest.raises(KeyboardInterrupt), ctrl_c_after(wait):
                while True:
                    indices.append(next(tables)["design_index"])
        indices += [table["design_index"] for table in tables]
        index = np.concatenate(indices)
        assert (np.diff(index.astype(np.int64)) > 0).all(), "rows come twice, or in another order"
        lost.append(len(slow) - len(index))
        if lost[-1] == 0:
            return
    pytest.fail(f"rows are lost each time: {lost}")


def test_csv_is_written_without_the_interpreter_and_ends_with_ctrl_c(long: beltspace.RowStream) -> None:
    table = long.to_table()
    with another_thread() as counted:
        csv = table.to_csv()
    assert counted[0] > 20 and csv.count(b"\n") == len(table) + 1
    with ctrl_c_after(0.1) as sent:
        with pytest.raises(KeyboardInterrupt):
            for _ in range(20):
                table.to_csv()
        took = time.perf_counter() - sent[0]
    assert took < 0.2, f"Ctrl-C took {took:.3f} s"
