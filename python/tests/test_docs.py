"""The pages of docs/ say what is true: blocks of Python run, and studies have the form that the schema tells."""

import json
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(sys.executable).with_name("beltspace")


PAGES = [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")]


@pytest.mark.parametrize("page", sorted(str(path.relative_to(ROOT)) for path in PAGES if "```python" in path.read_text()))
def test_the_python_of_a_page_runs(page: str, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pandas")
    monkeypatch.chdir(ROOT)
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / page).read_text(), re.S)
    names: dict[str, Any] = {}
    for block in blocks:
        exec(compile(block, page, "exec"), names)
    assert blocks


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


def test_the_reference_is_what_the_program_prints() -> None:
    page = subprocess.run([PROGRAM, "schema", "--markdown"], capture_output=True, text=True, check=True).stdout
    assert page == (ROOT / "docs" / "reference-study.md").read_text()


def test_man_pages_name_every_command(tmp_path: Path) -> None:
    subprocess.run([PROGRAM, "man", str(tmp_path)], check=True, capture_output=True)
    pages = {path.name for path in tmp_path.iterdir()}
    assert {"beltspace.1", "beltspace-sweep.1", "beltspace-check.1"} <= pages
    assert all((tmp_path / page).read_text().lstrip().startswith((".ie", ".TH", '.\\"')) for page in pages)
