"""What a call of ``maveric.stats`` found."""

from __future__ import annotations

import html
import json
from collections.abc import Iterator
from typing import Any


class Result:
    """What was found: names as attributes and keys, the command's report as text.

    A value that does not exist for the data is None, and ``undefined`` says why.

    Attributes
    ----------
    warnings : list of str
        What was left out or is doubtful.
    report : list of str
        The lines that the command prints.
    """

    def __init__(self, value: dict[str, Any], report: list[str], warnings: list[str]) -> None:
        self._value = value
        self.report = report
        self.warnings = warnings

    def to_dict(self) -> dict[str, Any]:
        """The values as plain dicts, lists and numbers, with the names of ``maveric stats --format json``."""
        copied: dict[str, Any] = json.loads(json.dumps(self._value))
        return copied

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError:
            raise AttributeError(f"{name}; there are {', '.join(self._value)}") from None

    def __getitem__(self, name: str) -> Any:
        found = self._value[name]
        return Result(found, [], []) if isinstance(found, dict) else found

    def __iter__(self) -> Iterator[str]:
        return iter(self._value)

    def __len__(self) -> int:
        return len(self._value)

    def __contains__(self, name: object) -> bool:
        return name in self._value

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._value]

    def __repr__(self) -> str:
        if not self.report:
            return json.dumps(self._value, ensure_ascii=False, indent=1)
        return "\n".join(self.report + [f"warning: {words}" for words in self.warnings])

    def _repr_html_(self) -> str:
        # Columns stand under each other, whatever the notebook's own letters are.
        return f'<pre style="font-family: monospace; white-space: pre">{html.escape(repr(self))}</pre>'
