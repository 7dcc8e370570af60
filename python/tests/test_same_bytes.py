"""What Python gives is what the program writes, to the last bit."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import beltspace
from conftest import STUDY


def run(*words: str, cwd: Path | None = None) -> subprocess.CompletedProcess[bytes]:
    """Runs the program as it comes with the wheel."""
    program = Path(sys.executable).with_name("beltspace")
    return subprocess.run([program, *words], cwd=cwd, capture_output=True, check=False)


@pytest.fixture(scope="session")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("program")
    (folder / "study.toml").write_text(STUDY)
    done = run("sweep", "study.toml", "--out", "out", "--no-report", cwd=folder)
    assert done.returncode == 0, done.stderr.decode()
    return folder / "out"


def test_every_table_and_the_picture_are_those_of_the_program(written: Path, result: beltspace.Result) -> None:
    assert result.front.to_csv() == (written / "front.csv").read_bytes()
    assert result.top is not None and result.top.to_csv() == (written / "top.csv").read_bytes()
    assert result.sample is not None and result.sample.to_csv() == (written / "sample.csv").read_bytes()
    tables = {**result.histograms, **result.maps}
    assert len(tables) == 2
    for name, table in tables.items():
        assert table.to_csv() == (written / f"{name}.csv").read_bytes()
    assert result.summary_json.encode() == (written / "summary.json").read_bytes()
    assert result.summary == json.loads((written / "summary.json").read_bytes())
    svg = result.svg()
    assert svg is not None and svg.encode() == (written / "front.svg").read_bytes()


def test_the_feasible_designs_are_those_of_the_program(written: Path, result: beltspace.Result) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    theirs = parquet.read_table(written / "feasible.parquet")
    assert result.feasible is not None and len(result.feasible) == result.feasible_designs == theirs.num_rows
    ours = result.feasible.to_pyarrow()
    assert ours.column_names == theirs.column_names
    assert all(ours[name].combine_chunks().equals(theirs[name].combine_chunks()) for name in ours.column_names)


@pytest.mark.parametrize("name", ["metal-cvt", "push-belt-duty", "push-belt-yield", "catalogue-v-belts", "timing-map"])
def test_scenarios_are_those_of_the_program(root: Path, name: str) -> None:
    table = beltspace.Study.from_file(root / "studies" / f"{name}.toml").scenario_table()
    assert table.to_csv() == (root / "results" / "studies" / name / "scenarios.csv").read_bytes()


@pytest.mark.parametrize("name", ["metal-cvt", "camshaft-torque", "scooter-variator", "catalogue-v-belts", "push-belt-duty"])
def test_shipped_studies_give_the_committed_fronts(root: Path, name: str) -> None:
    result = beltspace.Study.from_file(root / "studies" / f"{name}.toml").sweep()
    committed = (root / "results" / "studies" / name / "front.csv").read_bytes()
    assert result.front.to_csv() == committed
    # And as numbers, to the last bit.
    lines = committed.decode().splitlines()
    for at, column in enumerate(lines[0].split(",")):
        values = result.front[column]
        if values.dtype == np.float64 and not any('"' in line for line in lines):
            cells = [line.split(",")[at] for line in lines[1:]]
            assert values.tobytes() == np.array([float(it) if it else np.nan for it in cells]).tobytes() or np.isnan(values).any()


def test_threads_and_methods_change_nothing(study: beltspace.Study, result: beltspace.Result) -> None:
    for options in ({"threads": 1}, {"threads": 3, "method": "exhaustive"}, {"engine": "cpu"}):
        other = study.sweep(**options)  # type: ignore[arg-type]
        assert other.front.to_csv() == result.front.to_csv()
        assert other.summary == result.summary


def test_the_program_comes_with_the_wheel(tmp_path: Path) -> None:
    assert run("--version").stdout.decode().strip() == f"beltspace {beltspace.__version__}"
    module = subprocess.run([sys.executable, "-m", "beltspace", "models"], capture_output=True, check=True)
    assert module.stdout == run("models").stdout
    helped = subprocess.run([sys.executable, "-m", "beltspace", "--help"], capture_output=True, check=True)
    assert b"Usage: beltspace " in helped.stdout and helped.stdout == run("--help").stdout
    wrong = run("check", "nowhere.toml", cwd=tmp_path)
    assert wrong.returncode == 2 and b"cannot read study nowhere.toml" in wrong.stderr
    assert run("no-such-command").returncode == 2


def test_the_program_tells_where_it_is(tmp_path: Path, root: Path) -> None:
    """Job scripts name the program that wrote them: the command of this environment, not the interpreter."""
    done = run("slurm", str(root / "studies" / "timing-map.toml"), "--shards", "2", "--out", str(tmp_path / "out"), cwd=tmp_path)
    assert done.returncode == 0, done.stderr.decode()
    scripts = "\n".join(path.read_text() for path in tmp_path.rglob("*") if path.is_file())
    assert str(Path(sys.executable).with_name("beltspace")) in scripts
    assert os.path.basename(sys.executable) + " " not in scripts
