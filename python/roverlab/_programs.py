"""The programs of the project."""

from __future__ import annotations

import os
import shutil
import sysconfig


def find(name: str) -> str:
    """The file of a program: that of this environment, or else the first on the search path."""
    own = sysconfig.get_path("scripts")
    found = shutil.which(name, path=own) or shutil.which(name)
    if found is None:
        raise FileNotFoundError(f"the program {name} is not in {own} and not in PATH; expected it in one of them")
    return os.path.abspath(found)
