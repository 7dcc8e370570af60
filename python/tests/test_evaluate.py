"""Models evaluated for many rows."""

import gc
import subprocess
import sys
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest

import beltspace


def test_many_rows_are_the_same_as_the_program_gives(tmp_path: Path) -> None:
    random = np.random.default_rng(1)
    rows = {"friction": random.uniform(0.06, 0.1, 900), "ratio": random.uniform(0.5, 2, 900), "torque_Nm": random.uniform(10, 200, 900)}
    names = list(rows)
    lines = [",".join(names)] + [",".join(repr(float(rows[name][row])) for name in names) for row in range(900)]
    (tmp_path / "rows.csv").write_text("\n".join(lines) + "\n")
    program = Path(sys.executable).with_name("beltspace")
    words = [program, "eval", "metal-cvt", "--table", "rows.csv", "--out", "found.csv"]
    subprocess.run(words, cwd=tmp_path, check=True, capture_output=True)
    theirs = (tmp_path / "found.csv").read_text().splitlines()
    found = beltspace.evaluate("metal-cvt", rows)
    header = theirs[0].split(",")
    for name in found.column_names:
        cells = [line.split(",")[header.index(name)] for line in theirs[1:]]
        if name == "status":
            assert list(found["status"]) == cells
        else:
            assert found[name].tobytes() == np.array([float(it) if it else np.nan for it in cells]).tobytes(), name
    # Few rows take another way to the same numbers.
    few = beltspace.evaluate("metal-cvt", {name: column[:7] for name, column in rows.items()})
    assert all((few[name] == found[name][:7]).all() for name in few.column_names if name != "status")


def test_long_columns_outlive_their_table_and_are_those_of_short_ones() -> None:
    count = 600_000
    friction = np.random.default_rng(2).uniform(0.06, 0.1, count)
    found = beltspace.evaluate("metal-cvt", {"friction": friction}, outputs=["axial_force_N", "slip_margin"])
    forces, table = found["axial_force_N"], pa.table(found)
    del found
    gc.collect()
    assert not forces.flags.writeable
    for first in (0, 300_000, count - 1000):
        few = beltspace.evaluate("metal-cvt", {"friction": friction[first : first + 1000]})
        assert few["axial_force_N"].tobytes() == forces[first : first + 1000].tobytes()
    del forces
    gc.collect()
    margins = table["slip_margin"].to_numpy()
    assert len(margins) == count and margins[-1000:].tobytes() == few["slip_margin"].tobytes()


def test_memory_of_long_columns_is_used_again_but_never_by_two() -> None:
    count = 600_000
    frictions = [np.random.default_rng(seed).uniform(0.06, 0.1, count) for seed in (3, 4, 5)]

    def forces_of(friction: np.ndarray) -> np.ndarray:
        return beltspace.evaluate("metal-cvt", {"friction": friction}, outputs=["axial_force_N"])["axial_force_N"]

    first, second = forces_of(frictions[0]), forces_of(frictions[1])
    assert not np.shares_memory(first, second)
    place, copy = first.ctypes.data, second.copy()
    del first
    gc.collect()
    third = forces_of(frictions[2])
    # Elsewhere the system could not take them back, so that none are kept.
    assert sys.platform != "linux" or third.ctypes.data == place, "the pages of the first column were free"
    assert (second == copy).all()
    few = beltspace.evaluate("metal-cvt", {"friction": frictions[2][-1000:]}, outputs=["axial_force_N"])
    assert third[-1000:].tobytes() == few["axial_force_N"].tobytes()


def test_numbers_of_any_kind_are_columns_and_a_scalar_is_every_row() -> None:
    wanted = beltspace.evaluate("metal-cvt", {"band_count": [6.0, 7.0], "torque_Nm": [150.0, 150.0]})
    for counts in (range(6, 8), (6, 7), np.array([6, 7], dtype=np.int8), np.array([6, 0, 7, 0])[::2], np.float32([6, 7])):
        found = beltspace.evaluate("metal-cvt", {"band_count": counts, "torque_Nm": 150})
        assert (found["axial_force_N"] == wanted["axial_force_N"]).all()
    assert len(beltspace.evaluate("metal-cvt", {"torque_Nm": 150})) == 1
    assert len(beltspace.evaluate("metal-cvt", {"torque_Nm": []})) == 0
    with_unit = beltspace.evaluate("metal-cvt", {"band_thickness_mm": ["0.2", "200 um", "0.2 mm"]})
    assert len(set(with_unit["max_stress_MPa"])) == 1


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"frictoin": [0.1]}, 'column "frictoin": metal-cvt has no such input; did you mean "friction"?'),
        ({"friction": [0.1, -1.0]}, 'row 1, column "friction": '),
        ({"friction": [0.1, float("nan")]}, 'row 1, column "friction": '),
        ({"friction": [0.1], "ratio": [1.0, 2.0]}, "the column ratio has 2 rows, the column friction has 1"),
        ({"friction": np.zeros((2, 2))}, 'column "friction" has 2 dimensions'),
        ({"axial_force_N": [1.0]}, 'column "axial_force_N": it is a result and no input'),
        ({"friction": np.array(["2020-01-01"], dtype="datetime64[D]")}, 'column "friction": datetime64[D] is neither numbers nor texts'),
        ({1: [1.0]}, "a column is named by a text, not by 1"),
        (17, "a int is no table"),
        ({}, "there is no column with the values of an input"),
    ],
)
def test_wrong_tables_are_refused_by_name(table: object, message: str) -> None:
    with pytest.raises(beltspace.RequestError) as raised:
        beltspace.evaluate("metal-cvt", table)  # type: ignore[arg-type]
    assert message in str(raised.value)


def test_wrong_names_are_refused() -> None:
    with pytest.raises(beltspace.RequestError, match='unknown model "metal"; models are: rubber-cvt'):
        beltspace.evaluate("metal", {"friction": [0.1]})
    with pytest.raises(ValueError, match='metal-cvt has no output "force"'):
        beltspace.evaluate("metal-cvt", {"friction": [0.1]}, outputs=["force"])


def test_the_worst_of_rows_is_that_of_the_sweep(study: beltspace.Study, result: beltspace.Result) -> None:
    front = result.front
    found = study.worst({name: front[name] for name in study.design})
    for name in ("axial_force_upper_N", "stress_margin", "max_stress_MPa"):
        assert found[name].tobytes() == front[name].tobytes()
        assert (found[f"{name}_scenario"] == front[f"{name}_scenario"]).all()
    # Between the levels too, and one thread is as good as many.
    random = np.random.default_rng(2)
    rows = {"groove_angle_deg": random.uniform(18, 30, 40), "band_thickness_mm": random.uniform(0.1, 0.3, 40), "band_count": 9}
    assert study.worst(rows).to_csv() == study.worst(rows, threads=1).to_csv()
    with pytest.raises(beltspace.RequestError, match="there is no column band_count"):
        study.worst({"groove_angle_deg": [20], "band_thickness_mm": [0.2]})


BRAKE = {
    "tight_tension_N": "pull_N * exp(friction * wrap_deg / 1[rad])",
    "torque_Nm": "(tight_tension_N - pull_N) * drum_diameter_mm / 2",
}
INPUTS = {
    "pull_N": {"default": 100, "valid": [1, 1000], "doc": "Pull of the lever."},
    "friction": {"default": 0.3, "valid": [0.05, 0.8], "doc": "Coefficient of friction."},
    "wrap_deg": {"default": 270, "valid": [90, 350], "doc": "Angle of wrap."},
    "drum_diameter_mm": {"default": 250, "valid": [50, 1000], "doc": "Diameter of the drum."},
}


def test_a_model_of_formulas_is_evaluated_and_swept() -> None:
    brake = beltspace.Model("band-brake", BRAKE, inputs=INPUTS, outputs=["torque_Nm", "tight_tension_N"], summary="A band brake.")
    pulls = np.linspace(50, 400, 1000)
    found = beltspace.evaluate(brake, {"pull_N": pulls})
    tight = pulls * np.exp(0.3 * np.deg2rad(270))
    np.testing.assert_allclose(found["tight_tension_N"], tight, rtol=1e-14)
    np.testing.assert_allclose(found["torque_Nm"], (tight - pulls) * 0.125, rtol=1e-14)
    study = beltspace.Study.from_dict(
        {
            "model": brake,
            "design": {"pull_N": {"from": 20, "to": 400, "count": 39}, "wrap_deg": np.arange(200, 321, 10)},
            "uncertainty": {"friction": [0.25, 0.3, 0.35]},
            "constraints": {"torque_Nm": {"min": 30}},
            "objectives": {"pull_N": "min", "wrap_deg": "min"},
        }
    )
    result = study.sweep()
    assert result.designs == 39 * 13 and len(result.front) > 3
    # The least friction is the worst.
    worst = beltspace.evaluate(brake, {name: result.front[name] for name in study.design} | {"friction": 0.25})
    assert (worst["torque_Nm"] == result.front["torque_Nm"]).all() and worst["torque_Nm"].min() >= 30
    assert brake.inputs["wrap_deg"]["unit"] == "deg" and list(brake.outputs) == ["torque_Nm", "tight_tension_N"]


def test_a_model_that_is_wrong_says_where() -> None:
    with pytest.raises(beltspace.StudyError) as raised:
        beltspace.Model("brake", {"force_N": "2 * width_mm"}, inputs={"width_mm": {"default": 10, "valid": [1, 100]}})
    assert "force_N" in str(raised.value) and raised.value.line > 1
    with pytest.raises(beltspace.RequestError, match="unknown model"):
        beltspace.Model("no-such-model")
    assert beltspace.Model("metal-cvt").inputs["torque_Nm"]["unit"] == "Nm"
    assert beltspace.models()[:2] == ["rubber-cvt", "metal-cvt"]
