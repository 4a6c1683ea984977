"""The programs of the project, which are part of the extension."""

from __future__ import annotations

import os
import shutil
import signal
import sys
import sysconfig
from pathlib import Path

from ._native import run_robios, run_roverlab

# No name of a package, as its modules are for programs.
HOME = Path(__file__).parent / "robios-home"
"""Headers, library and modules of programs for RoBIOS."""


def find(name: str) -> str:
    """The file of a program: that of this environment, or else the first on the search path."""
    own = sysconfig.get_path("scripts")
    found = shutil.which(name, path=own) or shutil.which(name)
    if found is None:
        raise FileNotFoundError(f"the program {name} is not in {own} and not in PATH; expected it in one of them")
    return os.path.abspath(found)


def roverlab() -> int:
    """The program ``roverlab``. Returns its exit status."""
    _prepare()
    return run_roverlab(find("roverlab"), sys.argv)


def robios() -> int:
    """The program ``robios``. Returns its exit status."""
    _prepare()
    return run_robios(find("robios"), HOME, sys.argv)


def _prepare() -> None:
    """Lets Ctrl-C end the program at once, and programs in Python run in this environment."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    os.environ.setdefault("PYTHON", sys.executable)
