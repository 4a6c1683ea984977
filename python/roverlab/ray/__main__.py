"""A worker of ``roverlab starman --worker-command`` that passes individuals on to a Ray cluster.

Usage: python -m roverlab.ray ADDRESS WORD..., where the words are those of a worker of the program.
"""

from __future__ import annotations

import os
import select
import sys
import time
from collections.abc import Iterator
from importlib import import_module
from typing import Any

from ._worker import PIECE, answered

ATTEMPTS = 20
"""Number of attempts to connect to the cluster."""


def batches() -> Iterator[list[bytes]]:
    """Lines of standard input, as many at a time as there are."""
    rest = b""
    while chunk := os.read(0, 1 << 20):
        rest += chunk
        while not rest.endswith(b"\n") or select.select([0], [], [], 0)[0]:
            more = os.read(0, 1 << 20)
            if not more:
                break
            rest += more
        yield rest.splitlines(keepends=True)
        rest = b""


def main(address: str, words: tuple[str, ...]) -> None:
    """Answers questions until there are no more."""
    # What Ray prints must not be among the answers.
    output = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    ray = _connected_to(address)
    remote = ray.remote(answered).options(max_retries=-1)
    seconds = PIECE / 4
    for lines in batches():
        size = max(1, round(PIECE / seconds))
        pieces = [lines[first : first + size] for first in range(0, len(lines), size)]
        spent = 0.0
        for answers, taken in ray.get([remote.remote(words, piece) for piece in pieces]):
            output.writelines(answers)
            spent += taken
        output.flush()
        seconds = max(spent / len(lines), 1e-6)


def _connected_to(address: str) -> Any:
    ray = import_module("ray")
    # For some seconds Ray may lead to a node of this machine that has just been lost.
    for left in reversed(range(ATTEMPTS)):
        try:
            ray.init(address=address, log_to_driver=False, logging_level="ERROR")
            break
        except Exception:
            ray.shutdown()
            if left == 0:
                raise
            time.sleep(1.0)
    return ray


if __name__ == "__main__":
    main(sys.argv[1], tuple(sys.argv[2:]))
