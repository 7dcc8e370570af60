"""The examples run, and say what their text promises."""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import beltspace

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"


def run(*words: str) -> str:
    done = subprocess.run([sys.executable, *words], cwd=EXAMPLES, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_notebook_runs_and_shows_the_front() -> None:
    jupytext, nbclient = pytest.importorskip("jupytext"), pytest.importorskip("nbclient")
    pytest.importorskip("matplotlib")
    notebook = jupytext.read(EXAMPLES / "variator.py")
    nbclient.NotebookClient(notebook, timeout=240, resources={"metadata": {"path": str(EXAMPLES)}}).execute()
    shown = [output.get("data", {}) for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
    assert any("<svg" in it.get("text/html", "") for it in shown), "the front is a picture"
    assert any("image/png" in it for it in shown), "the plot is shown"
    assert "247599 designs, 434 scenarios" in str(shown)


def test_optimisers_find_less_than_the_exact_front(tmp_path: Path) -> None:
    pytest.importorskip("pymoo")
    pytest.importorskip("optuna")
    told = run("optimisers.py", str(tmp_path / "missed.png"), "--short")
    shares = [float(it) for it in re.findall(r"([\d.]+)% of the exact", told)]
    assert len(shares) == 3 and shares[0] == 100.0
    # They choose among the designs of the sweep, whose front nothing beats.
    assert all(50 < share <= 100 for share in shares[1:]), told
    # What the page says of the sweep.
    page = (EXAMPLES.parents[1] / "docs" / "python.md").read_text()
    assert "\n".join(f"# {line}" for line in told.splitlines()[1:2]) in page
    assert re.sub(r"in [\d.]+ s$", "", told.splitlines()[0]) in page
    assert (tmp_path / "missed.png").stat().st_size > 10_000


def test_salib_finds_what_decides() -> None:
    pytest.importorskip("SALib")
    told = dict(re.findall(r"(\w+): first order ([\d.-]+)", run("sobol_indices.py")))
    assert float(told["torque_Nm"]) > float(told["friction"])
    assert 0.8 < sum(map(float, told.values())) < 1.1


def test_openmdao_finds_the_best_of_a_fine_grid() -> None:
    pytest.importorskip("openmdao")
    told = {name: float(value) for name, value in re.findall(r"(\w+) = ([\d.]+)", run("openmdao_component.py"))}
    thickness, angle = (it.ravel() for it in np.meshgrid(np.linspace(0.1, 0.4, 301), np.linspace(18, 30, 241)))
    rows = {"band_thickness_mm": thickness, "groove_angle_deg": angle, "torque_Nm": 150.0, "band_count": 9}
    found = beltspace.evaluate("metal-cvt", rows, outputs=["axial_force_N", "stress_margin"])
    best = found["axial_force_N"][found["stress_margin"] >= 0.3].min()
    assert 0.299 <= told["stress_margin"] <= 0.301 and abs(told["axial_force_N"] / best - 1) < 1e-3, (told, best)
