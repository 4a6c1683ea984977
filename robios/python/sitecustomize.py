"""Loaded by Python at its start when the runner has put this folder on the path: makes time virtual for programs that
bring an eye.py of their own, or ask for the time before they import one."""

import os

if os.environ.get("ROBIOS_REPORT"):
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
