"""The compiled part of beltspace: studies, sweeps, tables, models."""

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, Literal, Protocol, TypeAlias, final

import numpy as np
import numpy.typing as npt

__version__: str

class _ArrowStream(Protocol):
    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object: ...

class _ArrowArray(Protocol):
    def __arrow_c_array__(self, requested_schema: object | None = None) -> tuple[object, object]: ...

_Cells: TypeAlias = npt.ArrayLike | Sequence[float] | Sequence[str] | float | str
Rows: TypeAlias = Mapping[str, _Cells] | _ArrowStream | _ArrowArray
"""Columns named like inputs: numbers in the unit that the name ends in, or texts such as "limit" or "0.25 in"; a single value stands
for every row. Any table that speaks Arrow will do: of pandas, polars, pyarrow, DuckDB, or beltspace itself."""

Array: TypeAlias = npt.NDArray[Any]
Progress: TypeAlias = Callable[[str, int, int], object]
"""Told what is done, how much of it, and how much there is, which is more than 0."""

@final
class Column:
    """A column of a table. `numpy.asarray(column)` is a view of its memory."""

    @property
    def name(self) -> str:
        """Its name, which ends in its unit, such as `axial_force_N`."""
    @property
    def unit(self) -> str:
        """Its unit, such as `N`; empty for plain numbers and texts."""
    @property
    def role(self) -> str:
        """`design`, `objective`, `constraint`, `report`, `label`, `index`, `output`, ...; several with commas between them."""
    @property
    def direction(self) -> str:
        """`min` or `max` for an objective, the bounds in words for a constraint, else empty."""
    @property
    def description(self) -> str:
        """What it is, in a sentence."""
    def __len__(self) -> int: ...
    def __buffer__(self, flags: int, /) -> memoryview: ...
    def to_numpy(self) -> Array:
        """The values as an array: a read-only view of numbers and indices; a copy of texts, and of indices of which some are absent
        (then NaN)."""
    def to_list(self) -> list[float | None] | list[int | None] | list[str]:
        """The values as a list; None where there is none."""

@final
class Table:
    """Columns of equal length. It speaks the Arrow PyCapsule interface: `polars.DataFrame(table)`, `pyarrow.table(table)`."""

    @property
    def num_rows(self) -> int:
        """Number of rows."""
    @property
    def num_columns(self) -> int:
        """Number of columns."""
    @property
    def column_names(self) -> list[str]:
        """Names of the columns, which end in their units."""
    @property
    def columns(self) -> list[Column]:
        """The columns, each with its unit, role and description."""
    def column(self, name: str) -> Column:
        """The column of that name; KeyError if there is none."""
    def __len__(self) -> int: ...
    def __contains__(self, name: str, /) -> bool: ...
    def __getitem__(self, name: str, /) -> Array: ...
    def __iter__(self) -> Iterator[str]: ...
    def row(self, row: int) -> dict[str, float | int | str | None]:
        """A row as a dictionary; rows count from 0, negative ones from the end. IndexError beyond."""
    def to_dict(self) -> dict[str, Array]:
        """Every column as an array, by name."""
    def to_pandas(self) -> Any:
        """As a pandas DataFrame; pandas must be installed. Index columns of which a cell is absent are floats."""
    def to_polars(self) -> Any:
        """As a polars DataFrame; polars must be installed."""
    def to_pyarrow(self) -> Any:
        """As a pyarrow Table; pyarrow must be installed."""
    def to_csv(self) -> bytes:
        """The bytes that the program writes for this table, as CSV: a header, the shortest numbers, nothing for absent values. The
        interpreter lock is released meanwhile; Ctrl-C raises KeyboardInterrupt."""
    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object: ...
    def __arrow_c_schema__(self) -> object: ...
    def _repr_html_(self) -> str: ...

@final
class RowStream:
    """A table that may be longer than the memory. Its rows are computed while they are read, 65 536 at a time, and it may be read again and
    again: `for table in rows`, `polars.DataFrame(rows)`, `pyarrow.RecordBatchReader.from_stream(rows)`. Ctrl-C ends the reading and raises
    KeyboardInterrupt; who reads a stream of Arrow may tell an error of its own first."""

    @property
    def num_rows(self) -> int:
        """Number of rows."""
    @property
    def num_columns(self) -> int:
        """Number of columns."""
    @property
    def column_names(self) -> list[str]:
        """Names of the columns, which end in their units."""
    def __len__(self) -> int: ...
    def __iter__(self) -> TableBatches:
        """The rows as tables of 65 536 rows, the last one shorter; each is computed when it is asked for. RuntimeError if the f64
        reference does not agree with the sweep. Who reads on after Ctrl-C misses no rows."""
    def to_table(self) -> Table:
        """All rows as a table, in memory."""
    def to_pandas(self) -> Any:
        """All rows as a pandas DataFrame, in memory; pandas must be installed."""
    def to_polars(self) -> Any:
        """All rows as a polars DataFrame, in memory; polars must be installed."""
    def to_pyarrow(self) -> Any:
        """All rows as a pyarrow Table, in memory; pyarrow must be installed."""
    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object: ...
    def __arrow_c_schema__(self) -> object: ...

@final
class TableBatches:
    """The tables of a `RowStream`, one after the other."""

    def __iter__(self) -> TableBatches: ...
    def __next__(self) -> Table: ...

@final
class Model:
    """A model: inputs, outputs and the formulas between them.

    `Model("metal-cvt")` is one that comes with beltspace, `Model("my-drive.toml")` that of a file, and `Model(name, formulas, ...)` one of
    formulas; the parts are those of a model's file (docs/models-in-a-file.md).

    name: of the model, or the path of its file; a text without formulas is a path where it ends in ".toml".
    formulas: texts by the name of what they give, which ends in its unit.
    inputs: by name, which ends in the unit: `default`, `valid`, `doc` and what else a model's file says of an input.
    outputs: names of the formulas that are outputs, None for all.

    The other parts are `conditions`, `curves`, `presets`, `base`, `units`, `summary`, `source` and `limits`.

    RequestError if parts are given without formulas or a base; StudyError tells all mistakes with line and column in the text that is
    made of the parts; OSError if the file cannot be read.
    """

    def __new__(
        cls,
        name: str | os.PathLike[str],
        /,
        formulas: Mapping[str, str | Mapping[str, Any]] | None = None,
        *,
        inputs: Mapping[str, Mapping[str, Any]] | None = None,
        outputs: Sequence[str] | Mapping[str, str | Mapping[str, Any]] | None = None,
        conditions: Mapping[str, Mapping[str, Any]] | None = None,
        curves: Mapping[str, Mapping[str, Any]] | None = None,
        presets: Mapping[str, Mapping[str, Any]] | None = None,
        base: str | None = None,
        units: Sequence[str] | None = None,
        summary: str | None = None,
        source: str | None = None,
        limits: str | None = None,
    ) -> Model: ...
    @staticmethod
    def from_file(path: str | os.PathLike[str]) -> Model:
        """Reads the file of a model; its name is that of the file. StudyError tells all mistakes; OSError if it cannot be read."""
    @staticmethod
    def from_toml(text: str, name: str, folder: str | os.PathLike[str] | None = None) -> Model:
        """Reads a model from the text of a file, under that name; `folder` is what paths of CSV files are relative to, by default the
        current one. StudyError tells all mistakes."""
    @property
    def name(self) -> str:
        """Its name."""
    @property
    def summary(self) -> str:
        """What it is, in a sentence."""
    @property
    def limits(self) -> str:
        """What the model does not say."""
    @property
    def text(self) -> str:
        """The text of its file; empty for a model of the program, and for that of a study."""
    @property
    def inputs(self) -> dict[str, dict[str, Any]]:
        """By name: `unit`, `default`, `valid` (in words), `usual` (the range that its source covers), `integer`, `words`, `description`."""
    @property
    def outputs(self) -> dict[str, dict[str, Any]]:
        """By name: `unit`, `description`."""

@final
class Result:
    """The result of a sweep: the same on every engine, by every method, on any number of threads. In a notebook it shows the front."""

    @property
    def designs(self) -> int:
        """Designs of the study."""
    @property
    def scenarios(self) -> int:
        """Scenarios in which each was judged."""
    @property
    def feasible_designs(self) -> int:
        """Designs that keep all constraints in all scenarios."""
    @property
    def front(self) -> Table:
        """The exact Pareto front, best of the first objective first: inputs, and every objective, constraint and report column at its worst
        scenario. Without objectives it has no rows."""
    @property
    def top(self) -> Table | None:
        """The best designs by one quantity, if the study asks for them."""
    @property
    def sample(self) -> Table | None:
        """A sample of the feasible designs, if the study asks for it."""
    @property
    def feasible(self) -> RowStream | None:
        """All feasible designs in the order of their indices, if the study or the sweep asks for them: a stream, as there may be more than
        the memory holds."""
    @property
    def variants(self) -> Table | None:
        """Every design, feasible or not, if the study asks for it."""
    @property
    def histograms(self) -> dict[str, Table]:
        """The bins of each histogram, by the name of its file."""
    @property
    def maps(self) -> dict[str, Table]:
        """The cells of each map, likewise."""
    @property
    def contours(self) -> dict[str, Table]:
        """The vertices of the contours of each map that has some, likewise."""
    @property
    def summary(self) -> dict[str, Any]:
        """What `summary.json` says: counts, ideal, knee, extremes, what limits feasibility, findings."""
    @property
    def summary_json(self) -> str:
        """The text of `summary.json`."""
    @property
    def knee(self) -> dict[str, float | int | str | None] | None:
        """The design of the front that is nearest to the ideal; None without a front."""
    @property
    def engine(self) -> Literal["cpu", "gpu"]:
        """What judged the designs."""
    @property
    def method(self) -> str:
        """`exhaustive`, `bounds`, or both if bounds were given up."""
    @property
    def seconds(self) -> float:
        """How long the designs took, in s."""
    @property
    def remarks(self) -> list[str]:
        """Remarks on the run, such as why a GPU was not taken."""
    def svg(self) -> str | None:
        """The picture of the front; None if the study has no objectives."""
    def _repr_html_(self) -> str: ...

@final
class Study:
    """A study: what is chosen, what must be survived, what nobody knows exactly, and what is asked."""

    @staticmethod
    def from_file(path: str | os.PathLike[str], *, models: Sequence[Model] | None = None) -> Study:
        """Reads a study file.

        path: of the file; paths in it are relative to its folder.
        models: models of one's own that it may name.

        StudyError tells all mistakes with line and column; OSError if the file cannot be read.
        """
    @staticmethod
    def from_toml(text: str, *, folder: str | os.PathLike[str] | None = None, models: Sequence[Model] | None = None) -> Study:
        """Reads a study from the text of a file.

        folder: what paths of other files are relative to, by default the current one.
        models: models of one's own that it may name.

        StudyError tells all mistakes with line and column; RequestError if it is the name of a file.
        """
    @staticmethod
    def from_dict(
        study: Mapping[str, Any], *, folder: str | os.PathLike[str] | None = None, models: Sequence[Model] | None = None
    ) -> Study:
        """Reads a study from a dictionary with the tables and keys of a study file.

        study: the order of its keys is that of the axes; its model may be a `Model`.
        folder: what paths of other files are relative to, by default the current one.
        models: models of one's own that it may name.

        StudyError tells all mistakes, with line and column in the text that is made of the dictionary; TypeError if a value has no form
        in a study.
        """
    def with_values(self, **values: float | str) -> Study:
        """The same study with values in place of what gives some inputs: an axis, a fixed value or a formula.

        values: numbers in the unit that the input's name ends in, or texts as in a study file, such as "25 mm".

        RequestError if there is no such input or its value is wrong.
        """
    @property
    def title(self) -> str:
        """Its title."""
    @property
    def text(self) -> str:
        """The text of its file."""
    @property
    def hash(self) -> str:
        """The hash of its content, as in the files of a result."""
    @property
    def model(self) -> Model:
        """Its model."""
    @property
    def designs(self) -> int:
        """How many designs it has."""
    @property
    def scenarios(self) -> int:
        """In how many scenarios each is judged."""
    @property
    def design(self) -> list[str]:
        """Names of the inputs that are chosen, in the order of the study."""
    def check(self, *, threads: int | None = None) -> dict[str, Any]:
        """What `beltspace check` tells, without running the study.

        threads: 1 to 4096, None for one on each core.

        Returns a dictionary: `designs`, `scenarios`, `evaluations`, `seconds` (about how long a sweep takes that judges each design),
        `method`, `memory_MB`, `front` (about how many designs) and `warnings`, a list of sentences.

        RequestError if the number of threads is wrong. Ctrl-C raises KeyboardInterrupt at once.
        """
    def sweep(
        self,
        *,
        progress: bool | Progress | None = None,
        threads: int | None = None,
        engine: Literal["auto", "cpu", "gpu"] = "auto",
        method: Literal["auto", "exhaustive", "bounds"] = "auto",
        adapter: str | None = None,
        feasible: bool = False,
    ) -> Result:
        """Judges every design in every scenario, and computes what is reported once more in f64.

        progress: True shows a bar (of tqdm, if it is installed). A function is called every 50 ms with what is done, how much of it,
            and how much there is, which is more than 0; what it raises ends the sweep.
        threads: 1 to 4096, None for one on each core.
        engine: "cpu", "gpu", or "auto", which takes a GPU where that is faster. The result is the same.
        method: "exhaustive" judges each design, "bounds" whole boxes of them, "auto" what is faster. The result is the same.
        adapter: a part of a GPU's name, where there are several.
        feasible: also keep every feasible design, as if the study asked for it.

        Returns the result, whose tables have the units that the names of their columns end in.

        RequestError if a word, the adapter or the number of threads is wrong, or the study cannot be served so; RunError if a front
        does not fit into memory or a GPU fails. The interpreter lock is released meanwhile; Ctrl-C ends the sweep, of which nothing is
        kept, and raises KeyboardInterrupt.
        """
    def scenario_table(self) -> Table:
        """Every scenario in which designs are judged: its number, its inputs in the units that their names end in, and its weight if the
        study has weights; as `scenarios.csv` of the program has them.

        RequestError if there are more than 2e7 scenarios.
        """
    def worst(self, table: Rows, *, threads: int | None = None) -> Table:
        """The worst of every row over the scenarios of the study, for an optimiser: a row is a design.

        table: a column for every input that the study chooses, in the unit that its name ends in, on the levels of the study or
            between them. It takes the forms that `evaluate` takes.
        threads: 1 to 4096, None for one on each core.

        Returns a table with the given inputs; every objective, constraint and report column at its worst, with the scenario where that
        is; the margin of each constraint, negative where it is violated; `feasible` ("yes" or "no"); and `status`: "ok", or why not
        in the first scenario that fails. Numbers that there are none of are NaN (null in Arrow).

        RequestError, with row and column, if a cell is empty (null, NaN, masked) or beyond the input's valid range, and if a name or the
        number of threads is wrong. The interpreter lock is released meanwhile; Ctrl-C ends the work and raises KeyboardInterrupt.
        """

def evaluate(
    model: Model | str | os.PathLike[str], table: Rows, *, outputs: Sequence[str] | None = None, threads: int | None = None
) -> Table:
    """Evaluates a model in f64 for every row of a table.

    model: a `Model`, the name of one that comes with beltspace, or the path of a model's file.
    table: columns named like inputs, in the units that the names end in: a dictionary of arrays, or a table of pandas, polars,
        pyarrow or DuckDB. A single value stands for every row, and inputs without a column have their defaults. Texts such as
        "limit" or "0.25 in" are read as in a study.
    outputs: names of the outputs that are wanted, None for all; fewer take less time.
    threads: 1 to 4096, None for one on each core.

    Returns a table with a column for each output, in the unit that its name ends in, and `status`: "ok", "overflow", or the first
    condition of the model that the row does not meet. A number that a failed condition invalidates is NaN (null in Arrow).

    RequestError, with row and column, if a cell is empty (null, NaN, masked) or beyond the input's valid range, and if a name or the
    number of threads is wrong. The interpreter lock is released meanwhile; Ctrl-C ends the work and raises KeyboardInterrupt.
    """

def models() -> list[str]:
    """Names of the models that come with beltspace."""

def run_program(words: Sequence[str]) -> int:
    """Runs the command line with these words, the path of the command first; returns the exit code."""
