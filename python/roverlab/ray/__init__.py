"""Campaigns and evolution on the machines of a Ray cluster.

Work is divided into pieces that depend on seeds and indices only. Ray asks a piece again whose machine is lost, and
the report is that of one machine, to the byte. Each machine needs this package; ``pip install roverlab[ray]`` brings
Ray. Without a connection, Ray is started on this machine.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from .._programs import find
from ._connection import connected
from ._fitness import OneByOne
from ._worker import part

__all__ = ["OneByOne", "campaign", "evolve"]

Progress = Callable[[int, int], None]
"""Is called with the number of pieces that are done, and of all."""
MOST_PARTS = 100_000
"""Number of parts that a campaign can have."""


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
        that was stopped goes on; they have to be of the same campaign. Without it, they are kept until the report is
        made.
    options : sequence of str
        Options of the command that affect no result, such as ``["--save", "failed"]`` of ``distbug``.
    progress : callable, optional
        Is called with the numbers of parts that are done, and of all, after each part.

    Returns
    -------
    str
        The report: the JSON object that the command prints with ``--json`` in one go, to the byte.

    Raises
    ------
    ValueError
        If ``parts`` is less than 1 or more than 100000, or ``folder`` has parts of another campaign.
    RuntimeError
        If a part or the report fails; the message is that of the program.
    """
    if not 1 <= parts <= MOST_PARTS:
        raise ValueError(f"parts is {parts}; expected 1 to {MOST_PARTS}")
    if folder is not None:
        Path(folder).mkdir(parents=True, exist_ok=True)
        return _campaign(list(arguments), parts, Path(folder), options, progress)
    with tempfile.TemporaryDirectory() as temporary:
        return _campaign(list(arguments), parts, Path(temporary), options, progress)


def _campaign(arguments: list[str], parts: int, folder: Path, options: Sequence[str], progress: Progress | None) -> str:
    expected = _checked(arguments, options)
    files = {number: folder / f"part-{number}-of-{parts}.jsonl" for number in range(1, parts + 1)}
    missing = [number for number, file in files.items() if not file.exists()]
    for number, file in files.items():
        if file.exists() and (found := _header(file)) != expected:
            what = "no part of a campaign" if found is None else f"a part of {_shown(found, expected)}"
            raise ValueError(f"folder is {folder}, whose {file.name} is {what}; expected {_shown(expected, found)}")
    done = parts - len(missing)
    ray = connected()
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


def _checked(arguments: list[str], options: Sequence[str]) -> dict[str, Any]:
    """What all parts of a campaign have in common. Wrong arguments and options are found before any part runs."""
    with tempfile.TemporaryDirectory() as temporary:
        # The last of so many parts has no run, unless the campaign is larger.
        file = Path(temporary) / "header.jsonl"
        result, trouble = part(arguments, MOST_PARTS, MOST_PARTS)
        if trouble:
            raise RuntimeError(trouble)
        file.write_bytes(result)
        header = _header(file)
        if header is None:
            raise RuntimeError(f"roverlab {' '.join(arguments)} wrote no part of a campaign")
        if options:
            # Right options lead to the other parts, which are missing.
            merge = [find("roverlab"), "merge", "--json", str(file), "--", *options]
            said = subprocess.run(merge, capture_output=True, text=True).stderr.strip()
            if not said.startswith(str(file)):
                raise RuntimeError(f"options: {said}")
        return header


def _header(file: Path) -> dict[str, Any] | None:
    """The first line of a part's file, without the part's number."""
    try:
        with file.open("rb") as lines:
            header = json.loads(lines.readline())
        del header["part"]
    except (ValueError, KeyError, TypeError):
        return None
    return dict(header)


def _shown(header: dict[str, Any], other: dict[str, Any] | None) -> str:
    """The command line of a header, and what else differs from another one."""
    line = " ".join([str(header.get("command")).replace("_", "-"), *map(str, header.get("options", ()))])
    others = [key for key in header if key not in ("command", "options") and other and header[key] != other.get(key)]
    return ", ".join([f"`{line}`", *(f"{key} {header[key]}" for key in others)])


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
