"""The programs that the wheel brings."""

import json
import os
import shutil
import signal
import subprocess
import sys
import sysconfig
import time
from pathlib import Path
from typing import Any

import pytest

from roverlab._programs import HOME

SCRIPTS = Path(sysconfig.get_path("scripts"))

PROGRAM_IN_PYTHON = """
from eye import *
import sys
LCDPrintf("%s", sys.prefix)
VWStraight(300, 200)
VWWait()
"""

PROGRAM_IN_C = """
#include "eyebot.h"
int main()
{
    LCDPrintf("%d mm", PSDGet(PSD_FRONT) > 0);
    VWStraight(300, 200);
    VWWait();
    return 0;
}
"""


def started(name: str, *arguments: str, folder: Path | None = None) -> subprocess.CompletedProcess[str]:
    """A program of this environment after its end; it need not be activated."""
    environment = {**os.environ, "PATH": os.defpath}
    environment.pop("PYTHON", None)
    command = [str(SCRIPTS / name), *arguments]
    return subprocess.run(command, capture_output=True, text=True, cwd=folder, env=environment, timeout=120)


def report(run: subprocess.CompletedProcess[str]) -> dict[str, Any]:
    answer: dict[str, Any] = json.loads(run.stdout)
    return answer


@pytest.fixture
def compiler() -> None:
    if shutil.which("cc") is None:
        pytest.skip("there is no C compiler `cc`")


def test_a_command_runs_and_prints_json(tmp_path: Path) -> None:
    run = started("roverlab", "distbug", "--json", folder=tmp_path)
    assert run.returncode == 0 and report(run)["outcome"] == "reached", run.stderr
    module = subprocess.run([sys.executable, "-m", "roverlab", "distbug", "--json"], capture_output=True, cwd=tmp_path)
    assert module.returncode == 0 and json.loads(module.stdout) == report(run)


def test_wrong_words_have_the_status_of_the_program() -> None:
    run = started("roverlab", "distbug", "--wrlds")
    assert run.returncode == 2 and "--wrlds" in run.stderr
    run = started("robios", "--json", "nothing.py")
    assert run.returncode == 2 and "nothing.py" in report(run)["error"]
    run = started("robios", "--version")
    assert run.returncode == 0 and run.stdout.startswith("robios ")


def test_text_without_a_line_s_end_is_written(tmp_path: Path) -> None:
    run = started("roverlab", "distbug", folder=tmp_path)
    assert run.returncode == 0 and len(run.stdout) > 20 and "picture" in run.stdout


def test_processes_are_the_program_s_own(tmp_path: Path) -> None:
    words = ["starman", "--population", "20", "--generations", "2", "--seed", "3", "--json"]
    alone, parted = (started("roverlab", *words, "--processes", count, folder=tmp_path) for count in ("1", "2"))
    assert alone.returncode == 0, alone.stderr
    # Only the number of processes differs.
    assert report(alone) == {**report(parted), "threads": 1}


def test_a_program_in_python_drives(tmp_path: Path) -> None:
    (tmp_path / "drive.py").write_text(PROGRAM_IN_PYTHON)
    run = started("robios", "--json", "drive.py", folder=tmp_path)
    answer = report(run)
    assert run.returncode == 0, run.stderr
    assert answer["outcome"] == "finished" and answer["path_length_mm"] == pytest.approx(300, abs=5)
    # Its modules are those of this environment.
    assert sys.prefix[:20] in answer["lcd_text"]


@pytest.mark.usefixtures("compiler")
def test_a_program_in_c_drives(tmp_path: Path) -> None:
    (tmp_path / "drive.c").write_text(PROGRAM_IN_C)
    run = started("robios", "--json", "drive.c", folder=tmp_path)
    assert run.returncode == 0, run.stderr
    answer = report(run)
    assert answer["outcome"] == "finished" and answer["path_length_mm"] == pytest.approx(300, abs=5)
    assert "1 mm" in answer["lcd_text"]


@pytest.mark.usefixtures("compiler")
def test_programs_and_commands_are_graded(tmp_path: Path) -> None:
    (tmp_path / "drive.c").write_text(PROGRAM_IN_C)
    (tmp_path / "room.wld").write_text("floor 2000 2000\n")
    (tmp_path / "rubric.toml").write_text(RUBRIC)
    run = started("roverlab", "grade", "--json", "rubric.toml", "drive.c", "roverlab first-steps", folder=tmp_path)
    programs = report(run)["programs"]
    assert len(programs) == 2 and programs[0]["reached"] == 2, run.stdout + run.stderr


RUBRIC = """
title = "Ahead"
seeds = 2
noise = 0.0
time_limit = 30

[[world]]
file = "room.wld"
start = [700, 1200, 0]
visit = [[1000, 1200, 50]]
"""


def test_what_programs_need_is_there() -> None:
    for file in ("include/eyebot.h", "bin/gccsim", "bin/g++sim", "python/eye.py", "lib/libeyesim.so"):
        assert (HOME / file).is_file(), file
    assert os.access(HOME / "bin" / "gccsim", os.X_OK)


def test_an_interrupt_ends_a_program(tmp_path: Path) -> None:
    words = ["distbug", "--campaign", "--worlds", "100000", "--json"]
    with subprocess.Popen([str(SCRIPTS / "roverlab"), *words], cwd=tmp_path, stdout=subprocess.DEVNULL) as run:
        time.sleep(2.0)
        run.send_signal(signal.SIGINT)
        assert run.wait(10.0) == -signal.SIGINT
