"""Opens tables with pandas, polars, pyarrow and DuckDB and compares what they read; see results/readers."""
import csv
import sys
import tempfile
from pathlib import Path

import duckdb
import numpy
import pandas
import polars
import pyarrow
import pyarrow.csv
import pyarrow.parquet

READERS = {
    ".csv": {
        "pandas": lambda path: of_pandas(pandas.read_csv(path)),
        "polars": lambda path: of_arrow(polars.read_csv(path, infer_schema_length=None).to_arrow()),
        "pyarrow": lambda path: of_arrow(pyarrow.csv.read_csv(path)),
        "DuckDB": lambda path: of_duckdb(f"read_csv('{path}', header = true, sample_size = -1)"),
    },
    ".parquet": {
        "pandas": lambda path: of_pandas(pandas.read_parquet(path)),
        "polars": lambda path: of_arrow(polars.read_parquet(path).to_arrow()),
        "pyarrow": lambda path: of_arrow(pyarrow.parquet.read_table(path)),
        "DuckDB": lambda path: of_duckdb(f"read_parquet('{path}')"),
    },
}


def of_pandas(frame):
    return {name: plain(frame[name]) for name in frame.columns}


def of_arrow(table):
    """Columns by name; a dictionary would keep the last of two of one name without a word."""
    if len(set(table.column_names)) < len(table.column_names):
        raise ValueError(f"two columns of one name: {table.column_names}")
    return {name: plain(table.column(name).to_pandas()) for name in table.column_names}


def of_duckdb(source):
    return of_pandas(duckdb.sql(f"select * from {source}").df())


def plain(column):
    """A column as all readers have it: numbers, or words, where nothing and an empty word are one."""
    if pandas.api.types.is_bool_dtype(column):
        return ["yes" if value else "no" for value in column]
    if pandas.api.types.is_numeric_dtype(column) or column.isna().all():
        return column.astype("float64").to_numpy(na_value=numpy.nan)
    return ["" if pandas.isna(value) else {"True": "yes", "False": "no"}.get(str(value), str(value)) for value in column]


def same(a, b):
    if isinstance(a, list) or isinstance(b, list):
        return isinstance(a, list) and isinstance(b, list) and a == b
    return numpy.array_equal(a, b, equal_nan=True)


def header(path):
    """The names of the columns, read by nobody who repairs them."""
    if path.suffix == ".parquet":
        return pyarrow.parquet.read_schema(path).names
    with path.open(newline="") as file:
        return next(csv.reader(file))


def complaints(path):
    """What is wrong with a table."""
    names = header(path)
    if len(set(names)) < len(names):
        yield f"two columns of one name: {names}"
    read = {}
    for reader, read_by in READERS[path.suffix].items():
        try:
            read[reader] = read_by(path)
        except Exception as error:
            yield f"{reader}: {error}"
    if not read:
        return
    if path.suffix == ".parquet":
        schema = pyarrow.parquet.read_schema(path)
        for name in names:
            if name in ("design_index", "scenario") or name.endswith("_scenario"):
                if not pyarrow.types.is_unsigned_integer(schema.field(name).type):
                    yield f"{name} is of type {schema.field(name).type}: an index is unsigned"
    first, expected = next(iter(read.items()))
    for reader, found in read.items():
        if list(found) != names:
            yield f"{reader}: columns {list(found)} instead of {names}"
            continue
        others = [name for name in names if not same(found[name], expected[name])]
        if others:
            yield f"{reader} reads other values than {first}, in {others}"
    twin = path.with_suffix(".parquet")
    if path.suffix == ".csv" and twin.exists() and len(read) == 4:
        columns = READERS[".parquet"]["pyarrow"](twin)
        if list(columns) != names or not all(same(columns[name], expected[name]) for name in names):
            yield f"{twin.name} has other values"


def bite():
    """A table with two columns of one name and a signed index must be complained of."""
    with tempfile.TemporaryDirectory() as folder:
        doubled, signed = Path(folder) / "doubled.csv", Path(folder) / "signed.parquet"
        doubled.write_text("design_index,mass_g,mass_g\n1,2,3\n")
        pyarrow.parquet.write_table(pyarrow.table({"design_index": pyarrow.array([1], pyarrow.int64())}), signed)
        silent = [path.name for path in (doubled, signed) if not list(complaints(path))]
    if silent:
        raise SystemExit(f"no complaint of {silent}: this program checks nothing")


def main():
    folder = Path(sys.argv[1])
    bite()
    paths = sorted(path for path in folder.rglob("*") if path.suffix in READERS)
    if not paths:
        raise SystemExit("there are no tables")
    wrong = 0
    for path in paths:
        for complaint in complaints(path):
            print(f"{path}: {complaint}")
            wrong += 1
    print(f"{len(paths)} tables, {wrong} complaints ({', '.join(READERS['.csv'])})")
    sys.exit(wrong > 0)


if __name__ == "__main__":
    main()
