"""Tables in numpy, pandas, polars, pyarrow and DuckDB, and back."""

import gc
import math

import numpy as np
import pytest

import beltspace


def test_numbers_are_the_tables_own_memory(result: beltspace.Result) -> None:
    column = result.front.column("axial_force_upper_N")
    first, second = column.to_numpy(), np.asarray(column)
    assert first.dtype == np.float64 and len(first) == len(result.front) > 5
    assert np.shares_memory(first, second)
    assert np.shares_memory(first, result.front["axial_force_upper_N"])
    with pytest.raises(ValueError):
        first[0] = 1.0
    # A view outlives everything else.
    copy = first.copy()
    del column, second
    gc.collect()
    assert (first == copy).all()


def test_columns_say_what_they_are(result: beltspace.Result) -> None:
    column = result.front.column("axial_force_upper_N")
    assert (column.unit, column.role, column.direction) == ("N", "objective", "min")
    assert column.description.endswith(".")
    assert result.front["design_index"].dtype == np.uint64
    with pytest.raises(KeyError, match='there is no column "axial_force"; there are: design_index'):
        result.front["axial_force"]
    assert "stress_margin" in result.front and "no" not in result.front
    assert list(result.front) == result.front.column_names
    assert result.front.row(0)["design_index"] == result.front["design_index"][0]
    assert result.front.row(-1)["design_index"] == result.front["design_index"][-1]
    with pytest.raises(IndexError):
        result.front.row(len(result.front))


def test_arrow_shares_the_memory_and_can_be_asked_again(result: beltspace.Result) -> None:
    pyarrow = pytest.importorskip("pyarrow")
    first, second = pyarrow.table(result.front), pyarrow.table(result.front)
    assert first.equals(second) and first.num_rows == len(result.front)
    field = first.schema.field("axial_force_upper_N")
    assert field.metadata[b"unit"] == b"N" and field.metadata[b"role"] == b"objective"
    chunk = first["axial_force_upper_N"].chunk(0)
    address = result.front["axial_force_upper_N"].__array_interface__["data"][0]
    assert chunk.buffers()[1].address == address
    schema = pyarrow.schema(result.front)
    assert schema.names == result.front.column_names
    # A capsule that nobody takes gives its memory back.
    for _ in range(1000):
        result.front.__arrow_c_stream__()


def test_a_long_table_comes_in_batches() -> None:
    pyarrow = pytest.importorskip("pyarrow")
    found = beltspace.evaluate("metal-cvt", {"friction": np.linspace(0.06, 0.1, 150_000)})
    reader = pyarrow.RecordBatchReader.from_stream(found)
    assert [batch.num_rows for batch in reader] == [65_536, 65_536, 18_928]


def test_pandas_and_back(result: beltspace.Result, study: beltspace.Study) -> None:
    pandas = pytest.importorskip("pandas")
    frame = result.front.to_pandas()
    assert list(frame.columns) == result.front.column_names
    pandas.testing.assert_frame_equal(frame, pandas.DataFrame(result.front.to_dict()))
    again = study.worst(frame[study.design])
    assert (again["axial_force_upper_N"] == result.front["axial_force_upper_N"]).all()
    assert set(again["feasible"]) == {"yes"}


def test_polars_and_back(result: beltspace.Result, study: beltspace.Study) -> None:
    polars = pytest.importorskip("polars")
    frame = polars.DataFrame(result.front)
    assert frame.equals(result.front.to_polars())
    assert frame.columns == result.front.column_names and frame.height == len(result.front)
    again = study.worst(frame.select(study.design))
    assert (again["stress_margin"] == frame["stress_margin"].to_numpy()).all()


def test_duckdb_reads_a_table(result: beltspace.Result) -> None:
    duckdb = pytest.importorskip("duckdb")
    front = result.front.to_pyarrow()
    least = duckdb.sql("select min(axial_force_upper_N) from front").fetchall()
    assert front.num_rows > 0 and least == [(result.front["axial_force_upper_N"].min(),)]


def test_absent_values_are_nan_in_numpy_and_null_in_arrow() -> None:
    pyarrow = pytest.importorskip("pyarrow")
    # Beyond slip there is no force.
    found = beltspace.evaluate("metal-cvt", {"traction": [0.3, 0.999]}, outputs=["axial_force_N", "traction_limit"])
    statuses = list(found["status"])
    assert statuses[0] == "ok" and statuses[1] != "ok"
    table = pyarrow.table(found)
    absent = np.isnan(found["axial_force_N"])
    assert table["axial_force_N"].null_count == int(absent.sum())
    assert [it is None for it in found.column("axial_force_N").to_list()] == list(absent)


def test_words_are_texts_both_ways() -> None:
    polars = pytest.importorskip("polars")
    rows = polars.DataFrame({"traction": ["limit", "0.4"], "torque_Nm": [100.0, 100.0]})
    found = beltspace.evaluate("metal-cvt", rows, outputs=["traction_used"])
    alone = beltspace.evaluate("metal-cvt", {"traction": "limit", "torque_Nm": 100.0}, outputs=["traction_used"])
    assert found["traction_used"][0] == alone["traction_used"][0]
    assert math.isclose(found["traction_used"][1], 0.4)
    categories = rows.with_columns(polars.col("traction").cast(polars.Categorical))
    assert (beltspace.evaluate("metal-cvt", categories, outputs=["traction_used"])["traction_used"] == found["traction_used"]).all()


def test_labels_are_texts(root: object) -> None:
    result = beltspace.Study.from_file(f"{root}/studies/catalogue-v-belts.toml").sweep()
    labels = [column for column in result.front.columns if column.role == "label"]
    assert labels and all(isinstance(text, str) for column in labels for text in column.to_list())
    assert all(result.front[column.name].dtype == object for column in labels)


def test_tables_and_results_show_themselves(result: beltspace.Result) -> None:
    assert repr(result.front).splitlines()[0] == f"<beltspace.Table: {len(result.front)} rows, {result.front.num_columns} columns>"
    page = result._repr_html_()
    assert "<svg" in page and f"{result.designs} designs" in page
    assert result.front._repr_html_().count("<tr>") == min(10, len(result.front)) + 1
    assert "A small push belt" in repr(result)
