"""Campaigns and evolution on the machines of a Ray cluster.

Work is divided into pieces that depend on seeds and indices only. Ray asks a piece again whose machine is lost, and
the report is that of one machine, to the byte. Each machine needs this package; ``pip install roverlab[ray]`` brings
Ray. Without a connection, Ray is started on this machine.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

from .._programs import find
from ._connection import connected
from ._fitness import OneByOne
from ._worker import part

__all__ = ["OneByOne", "campaign", "evolve"]

Progress = Callable[[int, int], None]
"""Is called with the number of pieces that are done, and of all."""


def campaign(
    arguments: Sequence[str],
    *,
    parts: int = 64,
    folder: str | os.PathLike[str] | None = None,
    options: Sequence[str] = (),
    progress: Progress | None = None,
) -> str:
    """Runs a campaign in parts on a cluster.

    Parameters
    ----------
    arguments : sequence of str
        Command line of the program ``roverlab``, such as ``["distbug", "--campaign", "--worlds", "1000"]``, without
        ``--json``, ``--part`` and ``--out``. Names of files have to be right on all machines.
    parts : int
        Number of parts. So many that one takes 50 ms or more keep machines busy until the end.
    folder : str or os.PathLike, optional
        Where the results of the parts are kept. Parts whose files are there already are not run again, so a campaign
        that was stopped goes on. Without it, they are kept until the report is made.
    options : sequence of str
        Options of the campaign that affect no result, such as ``["--csv", "table.csv"]``.
    progress : callable, optional
        Is called with the numbers of parts that are done, and of all, after each part.

    Returns
    -------
    str
        The report: the JSON object that the command prints with ``--json`` in one go, to the byte.

    Raises
    ------
    ValueError
        If ``parts`` is less than 1.
    RuntimeError
        If a part or the report fails; the message is that of the program.
    """
    if parts < 1:
        raise ValueError(f"parts is {parts}; expected at least 1")
    if folder is not None:
        Path(folder).mkdir(parents=True, exist_ok=True)
        return _campaign(list(arguments), parts, Path(folder), options, progress)
    with tempfile.TemporaryDirectory() as temporary:
        return _campaign(list(arguments), parts, Path(temporary), options, progress)


def _campaign(arguments: list[str], parts: int, folder: Path, options: Sequence[str], progress: Progress | None) -> str:
    ray = connected()
    files = {number: folder / f"part-{number}-of-{parts}.jsonl" for number in range(1, parts + 1)}
    missing = [number for number, file in files.items() if not file.exists()]
    done = parts - len(missing)
    # A part whose machine is lost is asked again, however often.
    remote = ray.remote(part).options(max_retries=-1)
    waiting = {remote.remote(arguments, number, parts): number for number in missing}
    try:
        while waiting:
            ready, _ = ray.wait(list(waiting))
            for reference in ready:
                number = waiting.pop(reference)
                result, trouble = ray.get(reference)
                if trouble:
                    raise RuntimeError(f"part {number} of {parts}: {trouble}")
                # A file of its name is complete.
                unfinished = files[number].with_suffix(".tmp")
                unfinished.write_bytes(result)
                unfinished.rename(files[number])
                done += 1
                if progress is not None:
                    progress(done, parts)
    finally:
        for reference in waiting:
            ray.cancel(reference)
    merge = [find("roverlab"), "merge", "--json", *(str(file) for file in files.values())]
    report = subprocess.run([*merge, *(["--", *options] if options else [])], capture_output=True, text=True)
    if not report.stdout:
        raise RuntimeError(report.stderr.strip())
    return report.stdout


def evolve(arguments: Sequence[str]) -> str:
    """Evolves gaits on a cluster.

    Individuals are evaluated in pieces of about 50 ms. With ``--checkpoint FILE`` an evolution that was stopped goes
    on.

    Parameters
    ----------
    arguments : sequence of str
        Command line of the program ``roverlab``, such as ``["starman", "--population", "200"]``, without
        ``--processes`` and ``--json``. Names of files have to be right on all machines.

    Returns
    -------
    str
        The report: the JSON object that the command prints with ``--json --processes 1``, to the byte.

    Raises
    ------
    RuntimeError
        If the evolution fails; the message is that of the program.
    """
    ray = connected()
    address = ray.get_runtime_context().gcs_address
    worker = f'"{sys.executable}" -m roverlab.ray {address}'
    own = ["--json", "--processes", "1", "--worker-piece", "100000", "--worker-command", worker]
    run = subprocess.run([find("roverlab"), *arguments, *own], capture_output=True, text=True)
    if run.returncode != 0:
        raise RuntimeError(run.stderr.strip() or run.stdout.strip() or f"status {run.returncode}")
    return run.stdout
