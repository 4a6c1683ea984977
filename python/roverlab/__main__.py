"""The program ``roverlab``. Usage: python -m roverlab WORD..."""

import sys

from ._programs import roverlab

if __name__ == "__main__":
    sys.argv[0] = "roverlab"
    sys.exit(roverlab())
