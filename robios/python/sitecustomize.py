"""Loaded by Python at its start when the runner has put this folder on the path: makes time virtual for programs that
bring an eye.py of their own, or ask for the time before they import one, and leads such an eye.py to the library."""

import os


def _lead_to_library(path):
    """Whoever loads the library of EyeSim, by whatever name and from wherever it was, gets this one."""
    import ctypes

    load = ctypes.CDLL.__init__

    def init(self, name=None, *arguments, **options):
        file = os.path.basename(str(name)).lower()
        if ("eyesim" in file or "eyebot" in file) and not os.path.exists(str(name)):
            name = path
        load(self, name, *arguments, **options)

    ctypes.CDLL.__init__ = init


def _answer_for_nobody():
    """Nobody sits at the input of a program that the runner has started: `input` returns an empty line, some times."""
    import builtins

    ask, left = builtins.input, [100]

    def input(*prompt):
        try:
            return ask(*prompt)
        except EOFError:
            left[0] -= 1
            if left[0] < 0:
                raise
            print()
            return ""

    builtins.input = input


def _seed_random(seed):
    """The runner's seed is that of every random stream; a program's own seed comes later and prevails."""
    import random

    random.seed(seed)


if os.environ.get("ROBIOS_LIBRARY"):
    _lead_to_library(os.environ["ROBIOS_LIBRARY"])
if os.environ.get("ROBIOS_MEMORY"):
    _answer_for_nobody()
    if os.environ.get("ROBIOS_SEED"):
        _seed_random(os.environ["ROBIOS_SEED"] + ":" + os.environ.get("ROBIOS_INDEX", "0"))
    try:
        import importlib.util
        import sys

        _here = os.path.join(os.path.dirname(os.path.abspath(__file__)), "eye.py")
        _spec = importlib.util.spec_from_file_location("random.eye", _here)
        _eye = importlib.util.module_from_spec(_spec)
        _spec.loader.exec_module(_eye)
        # Some published programs have `from random.eye import *`, which an editor once made of `from eye import *`.
        sys.modules["random.eye"] = _eye
    except (ImportError, OSError) as error:
        print(f"robios: {error}", file=sys.stderr)
