"""Tables that users give: of every package, with cells of every kind, and what is refused in them."""

import decimal
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import beltspace

FRICTION = [0.25, 0.0625, 0.125]


def forces(table: Any) -> bytes:
    return beltspace.evaluate("metal-cvt", table, outputs=["axial_force_N"])["axial_force_N"].tobytes()


def refused(table: Any) -> str:
    with pytest.raises(beltspace.RequestError) as raised:
        beltspace.evaluate("metal-cvt", table)
    assert isinstance(raised.value, ValueError)
    return str(raised.value)


def test_numbers_of_every_arrow_kind_are_taken() -> None:
    pyarrow = pytest.importorskip("pyarrow")
    wanted = forces({"friction": FRICTION})
    numbers = pyarrow.array(FRICTION)
    kinds = {
        "float32": numbers.cast(pyarrow.float32()),
        "float16": pyarrow.array(np.float16(FRICTION)),
        "decimal128": pyarrow.array([decimal.Decimal(str(it)) for it in FRICTION], pyarrow.decimal128(8, 5)),
        "decimal256": pyarrow.array([decimal.Decimal(str(it)) for it in FRICTION], pyarrow.decimal256(50, 5)),
        "dictionary": numbers.dictionary_encode(),
        "text": pyarrow.array([str(it) for it in FRICTION]),
        "text dictionary": pyarrow.array([str(it) for it in FRICTION]).dictionary_encode(),
    }
    for kind, column in kinds.items():
        assert forces(pyarrow.table({"friction": column})) == wanted, kind
    nothing = pyarrow.table({"friction": pyarrow.array([], pyarrow.string()).dictionary_encode()})
    assert len(beltspace.evaluate("metal-cvt", nothing)) == 0
    # The nearest number, not one that was rounded twice.
    exact = "0.1000000000000000055511151231257827"
    column = pyarrow.array([decimal.Decimal(exact)], pyarrow.decimal128(38, 34))
    assert forces(pyarrow.table({"friction": column})) == forces({"friction": [0.1]})


MODEL = beltspace.Model("switch", {"force_N": "2[N] + 3[N] * wet"}, inputs={"wet": {"default": 0, "valid": [0, 1]}})


def test_booleans_are_numbers_everywhere() -> None:
    pandas, polars, pyarrow = (pytest.importorskip(it) for it in ("pandas", "polars", "pyarrow"))
    cells = [True, False, True]
    objects = np.array(cells, dtype=object)
    for table in (pandas.DataFrame, polars.DataFrame, pyarrow.table, dict):
        assert list(beltspace.evaluate(MODEL, table({"wet": cells}))["force_N"]) == [5, 2, 5], table
    assert list(beltspace.evaluate(MODEL, {"wet": objects})["force_N"]) == [5, 2, 5]
    assert list(beltspace.evaluate(MODEL, {"wet": True})["force_N"]) == [5]


def test_pandas_needs_no_pyarrow(monkeypatch: pytest.MonkeyPatch) -> None:
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame({"friction": FRICTION, "band_count": [6, 7, 8], "traction": ["limit", "0.4", "limit"]})
    wanted = forces(frame)
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(ImportError):
        frame.__arrow_c_stream__()
    assert forces(frame) == wanted
    # Without a value numpy has NaN there, or an object of pandas.
    frame = pandas.DataFrame({"band_count": pandas.array([6, None], dtype="Int64")})
    assert refused(frame).startswith('row 1, column "band_count": ')
    objects = pandas.DataFrame({"band_count": pandas.array([6, None], dtype="Int64").astype(object)})
    assert refused(objects) == 'row 1, column "band_count": the cell is empty; give a value'
    assert "a Series is no table" in refused(frame["band_count"])


def test_the_index_of_a_frame_is_no_column() -> None:
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame({"friction": [0.3, *FRICTION]})
    assert forces(frame[frame.friction < 0.3]) == forces({"friction": FRICTION})


def test_what_is_no_table_is_told_so() -> None:
    pandas, polars, pyarrow = (pytest.importorskip(it) for it in ("pandas", "polars", "pyarrow"))
    for wrong in (pandas.Series(FRICTION), polars.Series(FRICTION), pyarrow.array(FRICTION), pyarrow.chunked_array([FRICTION])):
        assert refused(wrong).startswith(f"a {type(wrong).__name__} is no table, whose columns are named like inputs; give ")


def test_empty_cells_are_refused_with_their_place() -> None:
    pandas, polars, pyarrow = (pytest.importorskip(it) for it in ("pandas", "polars", "pyarrow"))
    told = 'row 2, column "friction": the cell is empty; give a value'
    cells = [0.1, 0.2, None]
    for table in (polars.DataFrame({"friction": cells}), pyarrow.table({"friction": cells}), pandas.DataFrame({"friction": cells})):
        assert refused(table) == told
    masked = np.ma.masked_array([0.1, 0.2, 0.3], mask=[False, False, True])
    assert refused({"friction": masked}) == told
    assert refused({"friction": np.array([0.1, 0.2, None], dtype=object)}) == told
    assert forces({"friction": masked[:2]}) == forces({"friction": [0.1, 0.2]})
    assert refused({"friction": np.ma.masked}) == 'row 0, column "friction": the cell is empty; give a value'
    dates = pyarrow.table({"friction": pyarrow.array([1, 2], pyarrow.date32())})
    assert refused(dates) == 'column "friction": Date32 is neither a number nor a text'


def test_arrays_that_stand_askew_are_read() -> None:
    askew = np.frombuffer(b"\0" + np.array(FRICTION).tobytes(), dtype=np.uint8)[1:].view(np.float64)
    assert not askew.flags.aligned
    assert forces({"friction": askew}) == forces({"friction": FRICTION})
    assert forces({"friction": np.array(FRICTION, dtype=">f8")}) == forces({"friction": FRICTION})


@pytest.mark.parametrize("threads", [0, -1, 4097, 1 << 80])
def test_threads_have_a_limit(threads: int, study: beltspace.Study) -> None:
    told = f"^threads = {threads}: write a whole number from 1 to 4096, or None for one on each core$"
    with pytest.raises(beltspace.RequestError, match=told):
        beltspace.evaluate("metal-cvt", {"friction": FRICTION}, threads=threads)
    for call in (study.sweep, study.check):
        with pytest.raises(beltspace.RequestError, match=told):
            call(threads=threads)
    with pytest.raises(beltspace.RequestError, match=told):
        study.worst({"band_count": [6]}, threads=threads)
    with pytest.raises(TypeError):
        study.check(threads="two")  # type: ignore[arg-type]


def test_messages_say_what_one_writes_in_python(study: beltspace.Study) -> None:
    told = [refused({"axial_force_N": [1.0]}), refused({"lot_number": [1.0]}), refused({})]
    assert told[0] == 'column "axial_force_N": it is a result and no input; drop the column'
    assert told[1] == 'column "lot_number": metal-cvt has no such input; drop the column'
    assert told[2].startswith("there is no column with the values of an input; inputs are ")

    def wrong(call: Any) -> None:
        with pytest.raises(beltspace.RequestError) as raised:
            call()
        told.append(str(raised.value))

    wrong(lambda: study.worst({"groove_angle_deg": [20]}))
    assert told[-1] == "the rows must say what the study chooses: there is no column band_thickness_mm, band_count; add it"
    wrong(lambda: study.with_values(torque=100))
    wrong(lambda: study.with_values(band_count="many"))
    wrong(lambda: study.with_values(stress_margin=3))
    wrong(lambda: study.sweep(engine="cpu", adapter="llvmpipe"))
    assert told[-1] == 'adapter names a GPU, but engine="cpu" was asked for'
    wrong(lambda: study.sweep(engine="gpu", method="bounds"))
    assert told[-1].startswith('method="bounds" judges on the CPU, but engine="gpu" was asked for')
    wrong(lambda: study.sweep(engine="gpu", adapter="no such card"))
    assert not [it for it in told if "--" in it]


def test_a_model_takes_what_it_is_given_or_says_why_not(tmp_path: Path) -> None:
    inputs = {"width_mm": {"default": 10, "valid": [1, 100]}}
    for wrong, name in (({"inputs": inputs}, "inputs"), ({"bogus": 3}, "bogus"), ({"inputs": inputs, "units": ["EUR"]}, "inputs, units")):
        with pytest.raises(beltspace.RequestError) as raised:
            beltspace.Model("metal-cvt", **wrong)
        assert str(raised.value).startswith(f"Model('metal-cvt') reads a model, which {name} cannot change; give formulas")
    with pytest.raises(beltspace.StudyError, match="bogus"):
        beltspace.Model("plate", {"area_mm2": "width_mm * 2[mm]"}, inputs=inputs, bogus=3)  # type: ignore[call-arg]
    plate = beltspace.Model("plate", formulas={"double_mm": "2 * width_mm"}, inputs=inputs)
    assert list(plate.outputs) == ["double_mm"] and "[formulas]" in plate.text
    file = tmp_path / "plate.toml"
    file.write_text(plate.text)
    for model in (beltspace.Model(file), beltspace.Model(str(file)), beltspace.Model.from_file(file)):
        assert (model.name, model.text) == ("plate", plate.text)
        assert list(beltspace.evaluate(model, {"width_mm": [3]})["double_mm"]) == [6]
    assert list(beltspace.evaluate(file, {"width_mm": [3]})["double_mm"]) == [6]
    assert beltspace.Model("metal-cvt", inputs=None).text == ""
    with pytest.raises(FileNotFoundError):
        beltspace.Model(tmp_path / "nowhere.toml")
    with pytest.raises(TypeError):
        beltspace.Model(3)  # type: ignore[arg-type]


def test_the_loader_of_vulkan_is_quiet_without_a_display(root: Path) -> None:
    code = (
        "import beltspace, os, sys\n"
        "study = beltspace.Study.from_file(sys.argv[1])\n"
        "study.sweep(engine='cpu')\n"
        "assert 'NODEVICE_SELECT' not in os.environ\n"
        "try:\n    study.sweep(engine='gpu', adapter='no such card')\n"
        "except beltspace.RequestError: pass\n"
        "print(os.environ.get('NODEVICE_SELECT'))\n"
    )
    environment = {name: value for name, value in os.environ.items() if name not in ("XDG_RUNTIME_DIR", "NODEVICE_SELECT")}
    file = root / "studies" / "camshaft-torque.toml"
    done = subprocess.run([sys.executable, "-c", code, str(file)], env=environment, capture_output=True, text=True, check=True)
    assert done.stderr == ""
    assert done.stdout == ("1\n" if sys.platform == "linux" else "None\n")
