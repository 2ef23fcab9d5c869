"""A study as a whole: its pipeline, and questionnaires."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

from . import _native
from ._arrow import Table, columns_of
from ._native import MavericError as Error


def run(pipeline: str | os.PathLike[str] | None = None, *words: str, folder: str | os.PathLike[str] = ".") -> str:
    """Bring a pipeline up to date, as ``maveric run`` does; progress is printed as it comes.

    Parameters
    ----------
    pipeline : path, optional
        The pipeline file; that of the folder's study when not given.
    *words : str
        Further words of the command, such as ``"--set"``, ``"seed=2"``.
    folder : path
        Where it runs.

    Returns
    -------
    str
        The summary of the run.

    Raises
    ------
    Error
        If a stage fails; what it said has been printed.
    """
    named = [] if pipeline is None else [os.fspath(pipeline)]
    return command("run", *named, *words, folder=folder)


def command(*words: str, folder: str | os.PathLike[str] = ".") -> str:
    """Run any command of ``maveric`` with these words and give what it prints, which is printed as it comes.

    Raises
    ------
    Error
        If it fails, with its last lines.
    """
    program = [sys.executable, "-m", "maveric", *words]
    with subprocess.Popen(
        program, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, encoding="utf-8"
    ) as process:
        assert process.stdout is not None
        lines = []
        try:
            for line in process.stdout:
                lines.append(line)
                print(line, end="", flush=True)
        except KeyboardInterrupt:
            process.send_signal(signal.SIGINT)
            process.wait()
            raise
    if process.returncode:
        raise Error("".join(lines[-20:]).strip() or f"maveric ended with status {process.returncode}")
    return "".join(lines)


def score(
    answers: Any, scale: str | os.PathLike[str], *, participant: str = "participant", items: list[str] | None = None
) -> tuple[Table, list[str]]:
    """Score answer sheets.

    Parameters
    ----------
    answers : data frame or dict of lists
        A row a person, a column an item; a missing answer is null.
    scale : str or path
        The id of a shipped scale (``adb``, ``mdsi``, ``mini_ipip``, ``jian_trust``, ...), or a file that defines one.
    participant : str
        The column that says who answered.
    items : list of str, optional
        The items' columns in order; those of the scale's own pattern when not given.

    Returns
    -------
    Table
        A row a score: ``participant``, ``score``, ``value`` (null where too few items were answered), ``answered``, ``items``.
    list of str
        What was left out or is doubtful.

    Raises
    ------
    Error
        For an answer that the scale cannot have, naming participant and item.

    Examples
    --------
    >>> import maveric
    >>> sheets = {"participant": ["P1"], "a": [6], "b": [2], "c": [5], "d": [1]}
    >>> maveric.score(sheets, "similarity", items=["a", "b", "c", "d"])[0].to_dict()["value"]  # b and d are reversed
    [6.0]
    """
    text = os.fspath(scale)
    if text.endswith(".toml"):
        try:
            text = Path(text).read_text(encoding="utf-8")
        except OSError as error:
            raise Error(f"{text}: {error.strerror}") from error
    columns, warnings = _native.score(columns_of(answers), text, participant, items)
    return Table(columns), warnings
