"""Recordings."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest

from roverlab import FileFormatError, log
from roverlab.log import Recording

LOGS = Path(__file__).parents[2] / "tests" / "data" / "logs"


@pytest.fixture(scope="module")
def recording() -> Recording:
    """A drive of DistBug."""
    return Recording.load(LOGS / "distbug.mcap")


def test_the_header(recording: Recording) -> None:
    assert recording.program == "distbug" and recording.robots == 1 and recording.version
    assert recording.span is not None and recording.span[1] > 1.0
    assert "/robot1/lidar" in recording.topics and "scene.wld" in recording.attachments
    assert repr(recording).startswith("<Recording: distbug, 1 robots, ")
    scene = recording.scene()
    assert scene is not None and len(scene.walls) > 0 and recording.start() is not None


def test_tables_have_columns_of_equal_length(recording: Recording) -> None:
    tables = (recording.scans(), recording.odometry(), recording.truth(), recording.distances(), recording.calls())
    for table in tables:
        assert len({len(column) for column in table.values()}) == 1  # type: ignore[arg-type]
        assert (np.diff(table["time"]) >= 0.0).all()
    scans, calls = recording.scans(), recording.calls()
    assert scans["ranges"].shape == (recording.topics["/robot1/lidar"], 60) and (scans["beams"] == 60).all()
    assert (scans["ranges"] > 0.0).all() and scans["angle_increment"][0] == pytest.approx(math.tau / 60)
    assert set(calls["method"]) >= {"set_speed", "scan_into", "pose"} and not any(calls["error"])
    assert len(calls["time"]) == recording.topics["/robot1/calls"] + recording.topics.get("/robot1/truth", 0)


def test_odometry_stays_near_the_truth(recording: Recording) -> None:
    odometry, truth, start = recording.odometry(), recording.truth(), recording.start()
    assert start is not None
    x = start[0] + math.cos(start[2]) * odometry["x"] - math.sin(start[2]) * odometry["y"]
    assert len(x) > 100
    if len(truth["time"]):
        at_end = np.interp(truth["time"][-1], odometry["time"], x)
        assert at_end == pytest.approx(truth["x"][-1], abs=0.3)


def test_bytes_are_read_as_files_are(recording: Recording) -> None:
    data = (LOGS / "distbug.mcap").read_bytes()
    assert np.array_equal(Recording.read(data).scans()["ranges"], recording.scans()["ranges"])
    assert Recording.load(LOGS / "ackermann.mcap").images()["image"] == []
    with pytest.raises(FileFormatError, match="data: .*; expected a recording"):
        Recording.read(data[:1000])
    with pytest.raises(FileFormatError):
        Recording.read(b"")
    with pytest.raises(TypeError, match="data is <class 'str'>; expected bytes"):
        Recording.read("")  # type: ignore[arg-type]
    with pytest.raises(FileNotFoundError, match="run.mcap does not exist; expected a file"):
        Recording.load("run.mcap")
    with pytest.raises(ValueError, match="robot is 1; expected an index below 1"):
        recording.scans(1)


def test_tables_as_files(recording: Recording, tmp_path: Path) -> None:
    log.save_csv(recording.scans(), tmp_path / "scans.csv")
    with open(tmp_path / "scans.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert float(rows[3]["ranges_7"]) == recording.scans()["ranges"][3, 7]
    log.save_csv(recording.calls(), tmp_path / "calls.csv")
    with open(tmp_path / "calls.csv", newline="") as file:
        assert [row["method"] for row in csv.DictReader(file)] == recording.calls()["method"]
    with pytest.raises(ValueError, match="lengths {'a': 1, 'b': 2}; expected equal ones"):
        log.save_csv({"a": [1], "b": [1, 2]}, tmp_path / "wrong.csv")
    with pytest.raises(ValueError, match="image is a column of arrays; expected numbers or texts"):
        log.save_csv({"image": [np.zeros((2, 2, 3))]}, tmp_path / "wrong.csv")


def test_a_file_for_rerun(recording: Recording, tmp_path: Path) -> None:
    pytest.importorskip("rerun")
    file = tmp_path / "run.rrd"
    log.to_rerun(recording, file)
    assert file.stat().st_size > 10_000


def test_without_rerun_an_error_says_what_to_install(recording: Recording, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(log, "_find_spec", lambda _: None)
    with pytest.raises(ModuleNotFoundError, match=r"expected: pip install roverlab\[rerun\]"):
        log.to_rerun(recording)
