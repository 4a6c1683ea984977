"""What runs on the machines of a cluster."""

from __future__ import annotations

import subprocess
import tempfile
import time
from pathlib import Path

from .._programs import find

PIECE = 0.05
"""Time that a piece should take (s): many times what a call of Ray costs, and short beside a generation."""
BLOCK = 256
"""Questions sent to a worker before their answers are read, which fit in a pipe."""

_workers: dict[tuple[str, ...], subprocess.Popen[bytes]] = {}
"""Workers of this machine's process, by their words."""


def answered(words: tuple[str, ...], questions: list[bytes]) -> tuple[list[bytes], float]:
    """The answers to some questions, by a worker on this machine, and the time taken (s)."""
    start = time.perf_counter()
    answers: list[bytes] = []
    for first in range(0, len(questions), BLOCK):
        answers += _block(words, questions[first : first + BLOCK])
    return answers, time.perf_counter() - start


def _block(words: tuple[str, ...], questions: list[bytes]) -> list[bytes]:
    trouble = ""
    # A worker that ends is started anew.
    for _ in range(3):
        worker = _workers.get(words)
        if worker is None:
            command = [find("roverlab"), *words]
            worker = _workers[words] = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        assert worker.stdin is not None and worker.stdout is not None
        try:
            worker.stdin.write(b"".join(questions))
            worker.stdin.flush()
            answers = [worker.stdout.readline() for _ in questions]
            if all(answers):
                return answers
            trouble = f"status {worker.wait()}"
        except OSError as error:
            trouble = str(error)
        del _workers[words]
    raise RuntimeError(f"a worker of roverlab ended: {trouble}")


def part(arguments: list[str], number: int, parts: int) -> tuple[bytes, str]:
    """Runs a part on a machine. Returns its file, and what went wrong."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "part.jsonl"
        # One thread, as each processor of the cluster has a part of its own.
        own = ["--threads", "1", "--part", f"{number}/{parts}", "--out", str(out)]
        words = [word for word in own if "--threads" not in arguments or word not in own[:2]]
        run = subprocess.run([find("roverlab"), *arguments, *words], capture_output=True, text=True)
        if run.returncode != 0 or not out.exists():
            return b"", (run.stderr or run.stdout).strip() or f"status {run.returncode}"
        return out.read_bytes(), ""
