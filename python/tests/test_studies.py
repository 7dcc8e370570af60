"""Studies from files, texts and dictionaries, what is wrong with them, and how they are stopped."""

import concurrent.futures
import multiprocessing
import os
import pickle
import signal
import threading
import time
import tomllib
from pathlib import Path
from typing import Any

import pytest

import beltspace
from conftest import STUDY, another_thread

BROKEN = """model = "metal-cvt"
[design]
band_thicknes_mm = { from = 0.1, to = 0.3, count = 5 }
band_count = { from = 6, to = 14.5 }
[objectives]
axial_force_N = "least"
"""


def test_all_mistakes_are_told_with_line_and_column() -> None:
    with pytest.raises(beltspace.StudyError) as raised:
        beltspace.Study.from_toml(BROKEN)
    error = raised.value
    assert [(it.line, it.column) for it in error.problems] == [(3, 1), (4, 31), (6, 17)]
    assert (error.line, error.column) == (3, 1)
    assert 'did you mean "band_thickness_mm"?' in error.problems[0].message
    assert str(error).splitlines()[0].startswith("study:3:1: ")
    assert isinstance(error, ValueError) and isinstance(error, beltspace.BeltspaceError)
    again = pickle.loads(pickle.dumps(error))
    assert again.problems == error.problems and str(again) == str(error)


def test_files_are_named_in_errors(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError) as raised:
        beltspace.Study.from_file(tmp_path / "nowhere.toml")
    assert raised.value.filename == str(tmp_path / "nowhere.toml")
    (tmp_path / "broken.toml").write_text(BROKEN)
    with pytest.raises(beltspace.StudyError, match=r"broken\.toml:3:1: "):
        beltspace.Study.from_file(tmp_path / "broken.toml")
    (tmp_path / "latin.toml").write_bytes(b'model = "metal-cvt"\ntitle = "\xe9"\n')
    with pytest.raises(beltspace.StudyError) as wrong:
        beltspace.Study.from_file(str(tmp_path / "latin.toml"))
    assert (wrong.value.line, wrong.value.column) == (2, 10)


def test_a_dictionary_is_the_same_study(study: beltspace.Study) -> None:
    of_dict = beltspace.Study.from_dict(tomllib.loads(STUDY))
    assert of_dict.hash == study.hash
    assert (of_dict.designs, of_dict.scenarios) == (study.designs, study.scenarios) == (13 * 11 * 9, 14)
    assert study.design == ["groove_angle_deg", "band_thickness_mm", "band_count"]
    with pytest.raises(TypeError, match=r"design\.band_count: object has no form in a study"):
        beltspace.Study.from_dict({"model": "metal-cvt", "design": {"band_count": object()}})


def test_values_replace_what_gives_an_input(study: beltspace.Study) -> None:
    other = study.with_values(torque_Nm=100, band_count=9)
    assert (other.designs, other.scenarios) == (13 * 11, 7)
    assert other.hash != study.hash and "torque_Nm = 100" in other.text
    with pytest.raises(beltspace.RequestError, match="torque"):
        study.with_values(torque=100)


def test_a_name_is_not_taken_for_the_text() -> None:
    with pytest.raises(beltspace.RequestError, match='"my.toml" is the name of a file; use Study.from_file'):
        beltspace.Study.from_toml("my.toml")


def test_wrong_words_are_refused(study: beltspace.Study) -> None:
    with pytest.raises(beltspace.RequestError, match='engine: unknown word "fpga"; write "auto" or "cpu" or "gpu"'):
        study.sweep(engine="fpga")  # type: ignore[arg-type]
    with pytest.raises(beltspace.RequestError, match="no adapter"):
        study.sweep(engine="gpu", adapter="no such card")
    with pytest.raises(TypeError, match="progress is True, False or a function"):
        study.sweep(progress=3)  # type: ignore[arg-type]


def big(root: Path) -> beltspace.Study:
    """A study that takes many seconds when each design is judged."""
    text = (root / "studies" / "metal-cvt.toml").read_text().replace("count = 61", "count = 1601").replace("step = 0.005", "step = 0.0005")
    return beltspace.Study.from_toml(text)


def test_ctrl_c_ends_a_sweep_at_once(root: Path) -> None:
    study = big(root)
    sent: list[float] = []

    def send() -> None:
        time.sleep(1.0)
        sent.append(time.perf_counter())
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=send)
    thread.start()
    with pytest.raises(KeyboardInterrupt):
        study.sweep(method="exhaustive")
    took = time.perf_counter() - sent[0]
    thread.join()
    assert took < 0.2, f"Ctrl-C took {took:.3f} s"


def test_ctrl_c_ends_a_check_at_once(root: Path) -> None:
    study = big(root)
    for _ in range(3):
        sent: list[float] = []

        def send(sent: list[float] = sent) -> None:
            sent.append(time.perf_counter())
            os.kill(os.getpid(), signal.SIGINT)

        timer = threading.Timer(0.05, send)
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            while True:
                study.check()
        took = time.perf_counter() - sent[0]
        timer.join()
        assert took < 0.2, f"Ctrl-C took {took:.3f} s"


def test_progress_is_told_of_what_is_known(study: beltspace.Study) -> None:
    shares: list[float] = []
    for _ in range(20):
        study.sweep(progress=lambda what, done, total: shares.append(done / total))
    assert all(0 <= it <= 1 for it in shares)


def test_other_threads_run_during_a_sweep(root: Path) -> None:
    study = big(root)
    told: list[tuple[str, int, int]] = []

    class Enough(Exception):
        pass

    def follow(what: str, done: int, total: int) -> None:
        told.append((what, done, total))
        if what == "judging designs" and len({it[1] for it in told}) > 4:
            raise Enough

    with another_thread() as counted, pytest.raises(Enough):
        study.sweep(progress=follow, method="exhaustive")
    assert counted[0] > 20
    done = [it[1] for it in told if it[0] == "judging designs"]
    assert done == sorted(done) and all(0 <= it[1] <= it[2] and it[2] > 0 for it in told)


def test_a_bar_is_shown_and_goes(root: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    study = beltspace.Study.from_file(root / "studies" / "metal-cvt.toml")
    study.sweep(progress=True)
    monkeypatch.setitem(__import__("sys").modules, "tqdm.auto", None)
    study.sweep(progress=True)
    shown = capsys.readouterr()
    assert shown.out == ""


def resident() -> int:
    """Resident memory in bytes."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="resident memory is read from /proc")
def test_a_hundred_sweeps_leak_nothing(study: beltspace.Study) -> None:
    def once() -> Any:
        result = study.sweep()
        result.front.__arrow_c_stream__()
        return result.front["stress_margin"].sum() + study.worst({name: result.front[name] for name in study.design})["stress_margin"].sum()

    sums = {once() for _ in range(30)}
    before = resident()
    sums |= {once() for _ in range(100)}
    grown = resident() - before
    assert len(sums) == 1
    assert grown < 4 << 20, f"100 sweeps left {grown} bytes"


def test_a_study_is_checked_without_running(root: Path) -> None:
    study = beltspace.Study.from_file(root / "studies" / "metal-cvt.toml")
    told = study.check()
    assert (told["designs"], told["scenarios"], told["evaluations"]) == (247_599, 434, 247_599 * 434)
    assert 0.001 < told["seconds"] < 600 and told["memory_MB"] > 0 and told["front"] > 0
    assert told["method"].startswith(("every design", "bounds"))
    beyond = study.with_values(strength_MPa=5000).check()["warnings"]
    assert any("strength_MPa = 5000 lies outside" in it for it in beyond), beyond


def test_worker_processes_take_studies_and_models(study: beltspace.Study, tmp_path: Path) -> None:
    changed = study.with_values(band_count=8)
    again = pickle.loads(pickle.dumps(changed))
    assert (again.hash, again.text, again.designs) == (changed.hash, changed.text, changed.designs)
    # With a model of one's own that reads a curve beside it, from another folder.
    (tmp_path / "pull.csv").write_text("speed_m_per_s,pull_N\n0,100\n10,60\n")
    text = """
[inputs]
speed_m_per_s = { default = 5, valid = { min = 0 }, doc = "Speed." }

[curves]
pull = { csv = "pull.csv", x = "speed_m_per_s", y = "pull_N" }

[formulas]
power_W = "pull(speed_m_per_s) * speed_m_per_s"
"""
    model = beltspace.Model.from_toml(text, "tug", tmp_path)
    own = beltspace.Study.from_dict({"model": model, "design": {"speed_m_per_s": [2, 5]}, "objectives": {"power_W": "max"}})
    kept = pickle.dumps((model, own, beltspace.Model("metal-cvt")))
    model_again, own_again, shipped = pickle.loads(kept)
    assert own_again.hash == own.hash and shipped.name == "metal-cvt"
    assert beltspace.evaluate(model_again, {"speed_m_per_s": [5.0]})["power_W"][0] == 400.0
    with pytest.raises(beltspace.RequestError, match="the model tug was taken from a study"):
        pickle.dumps(own.model)
    with concurrent.futures.ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        assert pool.submit(own.check, threads=1).result(timeout=60)["designs"] == 2
