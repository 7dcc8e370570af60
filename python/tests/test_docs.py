"""The pages of docs/ say what is true: blocks of Python run, and studies have the form that the schema tells."""

import json
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest

import beltspace

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(sys.executable).with_name("beltspace")


PAGES = [ROOT / "README.md", ROOT / "python" / "README.md", *(ROOT / "docs").rglob("*.md")]


@pytest.mark.parametrize("page", sorted(str(path.relative_to(ROOT)) for path in PAGES if "```python" in path.read_text()))
def test_the_python_of_a_page_runs(page: str, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pandas")
    monkeypatch.chdir(ROOT)
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / page).read_text(), re.S)
    names: dict[str, Any] = {}
    for block in blocks:
        exec(compile(block, page, "exec"), names)
    assert blocks


def test_what_the_readme_names_is_there() -> None:
    named = re.findall(r"`((?:docs|python)/[^` ]*)`", (ROOT / "python" / "README.md").read_text())
    assert len(named) > 4 and all((ROOT / path).exists() for path in named)


def test_exit_codes_are_as_told(tmp_path: Path) -> None:
    page = (ROOT / "docs" / "reference-results.md").read_text()
    commands = re.findall(r"^beltspace (.*?) +# exit code (\d)$", page, re.M)
    assert len(commands) == 3
    for words, code in commands:
        done = subprocess.run(["sh", "-c", f"exec '{PROGRAM}' {words}"], cwd=tmp_path, capture_output=True, check=False)
        assert done.returncode == int(code), (words, done.stderr.decode())


@pytest.fixture(scope="module")
def schema() -> Any:
    text = subprocess.run([PROGRAM, "schema"], capture_output=True, check=True).stdout
    return pytest.importorskip("jsonschema").Draft202012Validator(json.loads(text))


def test_every_study_has_the_form_that_the_schema_tells(schema: Any) -> None:
    schema.check_schema(schema.schema)
    files = [*ROOT.glob("studies/*.toml"), *ROOT.glob("benches/studies/*.toml")]
    assert len(files) > 15
    for file in files:
        problems = [f"{error.json_path}: {error.message}" for error in schema.iter_errors(tomllib.loads(file.read_text()))]
        assert not problems, f"{file.name}: {problems[:3]}"


def cases() -> list[tuple[str, str]]:
    """Broken studies of the reader's own test, each with what the reader says of it."""
    source = (ROOT / "tests/it/bad_studies.rs").read_text()
    study = re.search(r'const EXAMPLE: &str = r#"(.*?)"#;', source, re.S)
    assert study
    lines = study[1].splitlines()
    found = []
    for case in re.split(r"\n\s*\n", (ROOT / "tests/it/bad_studies/broken.txt").read_text()):
        edits = re.findall(r"^(\d+)\| ?(.*)$", case, re.M)
        told = "\n".join(line for line in case.splitlines() if re.match(r"\d+:\d+: ", line))
        if edits and told:
            new: dict[int, list[str]] = {}
            for number, text in edits:
                new.setdefault(int(number), []).append(text)
            parts = [part for at, line in enumerate(lines, 1) for part in new.get(at, [line])]
            found.append(("\n".join(parts), told))
    return found


def test_what_the_schema_can_see_it_refuses(schema: Any) -> None:
    broken = cases()
    assert len(broken) > 100
    seen = refused = 0
    for text, told in broken:
        try:
            study = tomllib.loads(text)
        except tomllib.TOMLDecodeError:
            continue
        valid = schema.is_valid(study)
        refused += not valid
        # Unknown keys at the top are seen by the form alone.
        if re.search(r'^\d+:\d+: unknown key "', told):
            seen += 1
            assert not valid, told
    assert seen >= 4 and refused >= 25, (seen, refused)


def reader_takes(uncertain: str) -> bool:
    """Does the reader take this as the uncertainty of a friction?"""
    text = f'model = "metal-cvt"\n[design]\nband_count = [6, 7]\n[uncertainty]\nfriction = {uncertain}\n[objectives]\nband_count = "min"\n'
    # With distributions something must be asked of the yield.
    for more in ("", "[constraints]\nyield = { min = 0.5 }\n"):
        try:
            beltspace.Study.from_toml(text + more, folder=ROOT / "docs")
        except beltspace.StudyError:
            continue
        return True
    return False


def schema_takes(schema: Any, uncertain: str) -> bool:
    try:
        study = tomllib.loads(f'model = "metal-cvt"\n[uncertainty]\nfriction = {uncertain}\n')
    except tomllib.TOMLDecodeError:
        # A key that stands twice.
        return False
    return bool(schema.is_valid(study))


# One of each distribution that a friction may have, in every form that the reader takes.
DISTRIBUTIONS = [
    "{ uniform = [0.07, 0.09] }",
    "{ uniform = { from = 0.07, to = 0.09 } }",
    "{ normal = { mean = 0.08, sd = 0.002 } }",
    "{ normal = { mean = 0.08, sd = 0.002 }, from = 0.07, to = 0.09 }",
    "{ lognormal = { mean = 0.08, sd = 0.002 } }",
    "{ triangular = [0.07, 0.08, 0.09] }",
    "{ triangular = { from = 0.07, mode = 0.08, to = 0.09 } }",
    "{ beta = { alpha = 2, beta = 3, from = 0.07, to = 0.09 } }",
    "{ weibull = { shape = 2, scale = 0.08 } }",
    "{ weibull = { shape = 2, scale = 0.01, from = 0.07 } }",
    "{ gumbel = { mode = 0.08, scale = 0.002 } }",
    "{ exponential = { mean = 0.08 } }",
    "{ discrete = { values = [0.07, 0.08], weights = [1, 3] } }",
    "{ empirical = [0.07, 0.075, 0.08, 0.09] }",
    "{ times = { normal = { mean = 1, sd = 0.05 } } }",
    "{ times = [0.9, 1.1] }",
    "{ times = { from = 0.9, to = 1.1, count = 3 } }",
    "{ plus = { uniform = [-0.01, 0.01] } }",
    "[0.07, 0.08]",
    "{ from = 0.07, to = 0.09, count = 3 }",
]


@pytest.mark.parametrize("uncertain", DISTRIBUTIONS)
def test_schema_and_reader_take_the_same_distributions(schema: Any, uncertain: str) -> None:
    assert reader_takes(uncertain) and schema_takes(schema, uncertain)
    # Every key that is left out, misspelt or doubled is judged alike by both.
    changes = {uncertain.replace(key, f"{key}x", 1) for key in re.findall(r"\b(\w+) = ", uncertain)}
    # Whole numbers need no count: whether it may be left out hangs on the input.
    changes |= {re.sub(r",\s*}", " }", re.sub(rf"\b{key} = [\d.]+(, )?", "", uncertain, count=1)) for key in re.findall(r"\b(\w+) = [\d.]", uncertain) if key != "count"}
    changes |= {uncertain.replace("{ ", "{ other = 1, ", 1), uncertain.replace("{ ", "{ exponential = { mean = 1 }, ", 1)}
    refused = 0
    for changed in changes - {uncertain}:
        takes = reader_takes(changed)
        refused += not takes
        assert schema_takes(schema, changed) == takes, changed
    assert refused > 0 or uncertain.startswith("[")


def test_lists_of_parameters_have_their_length(schema: Any) -> None:
    for wrong in ("{ uniform = [0.07] }", "{ triangular = [0.07, 0.09] }", "{ normal = [0.08, 0.002] }", "{ empirical = { csv = \"a.csv\" } }"):
        assert not reader_takes(wrong) and not schema_takes(schema, wrong), wrong


MODEL = """
summary = "A brake"
source = "A book"
limits = "Heat is left out."
units = ["EUR"]
[inputs.pull_N]
default = 100
valid = [1, 1000]
usual = [10, 500]
symbol = "F"
doc = "Pull."
source = "chosen"
[inputs.friction]
default = 0.3
valid = { above = 0, max = 2 }
[inputs.surface]
default = "dry"
words = ["dry", "wet"]
[inputs.film_um]
default = 2
only_for = { surface = ["wet"] }
[inputs.blocks]
default = 4
integer = true
valid = { min = 1, below = 100 }
[inputs.rear_pull_N]
default = 100
follows = "pull_N"
[formulas]
wrap_force_N = "pull_N * exp(friction * 4)"
help_N = { is = "wrap_force_N - pull_N + 0 * rear_pull_N", hidden = true }
total = { is = "round(2 * blocks)", integer = true }
cost_EUR = { is = "2[EUR] * blocks", worst = "highest", symbol = "c", doc = "Cost.", source = "chosen" }
torque_Nm = "help_N * 0.1[m]"
[conditions."too weak"]
margin = "wrap_force_N - 1[N]"
strict = true
doc = "It pulls."
[conditions."no torque"]
margin = "torque_Nm"
quiet = true
invalidates = ["torque_Nm"]
[outputs]
wrap_force_N = "Force of the wrap."
torque_Nm = { worst = "lowest", symbol = "T", doc = "Torque.", source = "chosen" }
cost_EUR = "Cost."
[presets.strong]
pull_N = 500
"""


def model_reader_takes(text: str, name: str = "brake", folder: Path = ROOT) -> bool:
    try:
        beltspace.Model.from_toml(text, name, folder)
    except beltspace.StudyError:
        return False
    return True


@pytest.fixture(scope="module")
def model_schema() -> Any:
    text = subprocess.run([PROGRAM, "schema", "--model"], capture_output=True, check=True).stdout
    return pytest.importorskip("jsonschema").Draft202012Validator(json.loads(text))


def test_the_schema_takes_every_model_file(model_schema: Any) -> None:
    model_schema.check_schema(model_schema.schema)
    pages = (ROOT / "docs/models-in-a-file.md").read_text()
    shown = [it for it in re.findall(r"```toml\n(.*?)```", pages, re.S) if "model" not in tomllib.loads(it)]
    files = sorted((ROOT / "tests/it/formulas/models").glob("*.toml"))
    texts = [MODEL, *shown, *(text for text in map(Path.read_text, files) if "model" not in tomllib.loads(text))]
    assert shown and len(texts) >= 6
    for text in texts:
        problems = [f"{error.json_path}: {error.message}" for error in model_schema.iter_errors(tomllib.loads(text))]
        assert not problems, problems[:3]
    assert model_reader_takes(MODEL)


def test_schema_and_reader_refuse_the_same_keys_of_models(model_schema: Any) -> None:
    lines = MODEL.strip().splitlines()
    judged = refused = 0
    for at, line in enumerate(lines):
        # A key that nobody knows in each table, keys that are misspelt, and values of another kind.
        changes = [[line, 'other = "x"'] if line.startswith(("[inputs", "[conditions")) else []]
        key = re.match(r"(\w+) = (.*)", line)
        known = key and key[1] not in ("pull_N", "wrap_force_N", "help_N", "total", "cost_EUR", "torque_Nm")
        if key and known:
            changes += [[f"{key[1]}x = {key[2]}"], [f"{key[1]} = [true]"]]
        if "{ " in line:
            changes += [[line.replace("{ ", "{ other = 1, ")]]
        for change in filter(None, changes):
            text = "\n".join([*lines[:at], *change, *lines[at + 1 :]])
            reader, form = model_reader_takes(text), model_schema.is_valid(tomllib.loads(text))
            judged += 1
            refused += not reader
            assert reader == form, change
    assert judged > 60 and refused > 50, (judged, refused)


def test_the_reference_is_what_the_program_prints() -> None:
    page = subprocess.run([PROGRAM, "schema", "--markdown"], capture_output=True, text=True, check=True).stdout
    assert page == (ROOT / "docs" / "reference-study.md").read_text()


def test_man_pages_name_every_command(tmp_path: Path) -> None:
    subprocess.run([PROGRAM, "man", str(tmp_path)], check=True, capture_output=True)
    pages = {path.name for path in tmp_path.iterdir()}
    assert {"beltspace.1", "beltspace-sweep.1", "beltspace-check.1"} <= pages
    assert all((tmp_path / page).read_text().lstrip().startswith((".ie", ".TH", '.\\"')) for page in pages)
