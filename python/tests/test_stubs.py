"""Stubs and docstrings hold what they promise."""

import ast
import inspect
import subprocess
import sys
from pathlib import Path

import pytest

import beltspace
from beltspace import _beltspace

HERE = Path(__file__).resolve().parent


def mypy(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", *words], cwd=HERE.parent, capture_output=True, text=True, check=False)


def test_the_package_and_its_users_pass_mypy_strict() -> None:
    pytest.importorskip("mypy")
    done = mypy("mypy", "--strict", "--ignore-missing-imports", "package/beltspace", "tests/typed.py")
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_wrong_call_does_not_pass_mypy(tmp_path: Path) -> None:
    pytest.importorskip("mypy")
    wrong = tmp_path / "wrong.py"
    wrong.write_text('import beltspace\nbeltspace.Study.from_toml("").sweep(engine="fpga", threads="2")\nbeltspace.Table().rows\n')
    done = mypy("mypy", "--strict", str(wrong))
    assert done.returncode == 1
    for part in ('"engine"', '"threads"', '"rows"'):
        assert part in done.stdout


def test_stubs_name_what_there_is() -> None:
    pytest.importorskip("mypy")
    done = mypy("mypy.stubtest", "beltspace", "--ignore-positional-only", "--ignore-unused-allowlist", "--allowlist", str(HERE / "stubtest.txt"))
    assert done.returncode == 0, done.stdout + done.stderr


def test_everything_public_is_described() -> None:
    for name in beltspace.__all__:
        if name.startswith("__"):
            continue
        thing = getattr(beltspace, name)
        assert inspect.getdoc(thing), name
        for member, value in vars(thing).items() if isinstance(thing, type) else ():
            if not member.startswith("_") and callable(value):
                assert inspect.getdoc(value), f"{name}.{member}"
    assert _beltspace.__version__ == beltspace.__version__


def described() -> dict[str, str]:
    """What the stubs say of each class, function and method, by its name."""
    tree = ast.parse((HERE.parent / "package" / "beltspace" / "_beltspace.pyi").read_text())
    found: dict[str, str] = {}
    for node in tree.body:
        if isinstance(node, ast.ClassDef | ast.FunctionDef):
            members = [it for it in node.body if isinstance(it, ast.FunctionDef)] if isinstance(node, ast.ClassDef) else []
            named = {node.name: ast.get_docstring(node)}
            # Python has words of its own for __iter__ and the like.
            named |= {f"{node.name}.{it.name}": ast.get_docstring(it) for it in members if not it.name.startswith("__")}
            found |= {name: text for name, text in named.items() if text}
    return found


def test_help_says_what_the_stubs_say() -> None:
    texts = described()
    assert len(texts) > 60 and {"evaluate", "Study.sweep", "Model", "Result.front", "Table.to_csv"} <= set(texts)
    for name, text in texts.items():
        thing: object = _beltspace
        for part in name.split("."):
            thing = inspect.getattr_static(thing, part) if isinstance(thing, type) else getattr(thing, part)
        told = inspect.getdoc(getattr(thing, "__func__", thing))
        # Lines may be of another length.
        assert told and told.split() == text.split(), name


def test_help_tells_parameters_units_errors_and_absent_values() -> None:
    for thing in (beltspace.evaluate, beltspace.Study.sweep, beltspace.Study.worst, beltspace.Study.check):
        told = inspect.getdoc(thing) or ""
        for name in list(inspect.signature(thing).parameters):
            assert name == "self" or f"\n{name}: " in told, (thing, name)
        assert "RequestError" in told and "Returns " in told
    for thing in (beltspace.evaluate, beltspace.Study.worst):
        assert all(it in (inspect.getdoc(thing) or "") for it in ("NaN", "status", "unit"))
    assert str(inspect.signature(beltspace.evaluate)) == "(model, table, *, outputs=None, threads=None)"
    sweep = "(self, /, *, progress=None, threads=None, engine='auto', method='auto', adapter=None, feasible=False)"
    assert str(inspect.signature(beltspace.Study.sweep)) == sweep
