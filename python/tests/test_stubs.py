"""Stubs and docstrings hold what they promise."""

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
