"""From the arguments of a function of ``bonetk.commands`` to the words of a command line, and from its end to a result."""
from __future__ import annotations

import numbers
import os
from typing import TYPE_CHECKING, Any

from . import _bonetk

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from typing import Union

    Path = Union[str, "os.PathLike[str]"]
    Progress = Callable[[str, float], object]
    # Name of the argument, of the option (empty: by its place) and of what turns a flag off; whether it is a flag; how
    # many values a time the option is named (0: all at once).
    Table = tuple[tuple[str, str, str, bool, int], ...]


class Result:
    """What a command did.

    command: the command line of the program bonetk that does the same
    text: what it printed
    warnings: one line each
    outputs: files that it wrote, as they were named; folders, and files in them, by their whole path
    messages: what the program writes to its standard error: warnings and, with ``verbose``, the seconds of stages
    """

    __slots__ = ("command", "text", "warnings", "outputs", "messages")

    def __init__(self, command: str, text: str, warnings: tuple[str, ...], outputs: tuple[str, ...], messages: str) -> None:
        self.command = command
        self.text = text
        self.warnings = warnings
        self.outputs = outputs
        self.messages = messages

    def __repr__(self) -> str:
        return f"<bonetk.commands.Result of {self.command!r}: {len(self.outputs)} outputs, {len(self.warnings)} warnings>"

    def __str__(self) -> str:
        return self.text


def _word(argument: str, value: Any) -> str:
    """A number, name or path as the program reads it."""
    if isinstance(value, bool):
        raise TypeError(f"{argument} takes a value, not {value}")
    if isinstance(value, numbers.Integral):
        return str(int(value))
    if isinstance(value, numbers.Real):
        return float.__repr__(float(value))
    word = os.fsdecode(value) if isinstance(value, (str, bytes, os.PathLike)) else None
    if word is None:
        raise TypeError(f"{argument} must be a string, a path or a number, not {type(value).__name__}")
    if "\0" in word:
        raise ValueError(f"{argument} has a null character")
    return word


def _flat(argument: str, value: Any) -> list[str]:
    """The words of a value, of a sequence, or of a sequence of sequences, as of balls or points."""
    if isinstance(value, (str, bytes, os.PathLike, numbers.Number)):
        return [_word(argument, value)]
    try:
        items = list(value)
    except TypeError:
        return [_word(argument, value)]
    return [word for item in items for word in _flat(argument, item)]


def _is_number(word: str) -> bool:
    return word[1:2].isdigit() or word[1:2] == "."


def words_of(table: Table, values: Mapping[str, Any]) -> list[str]:
    """The words after the command's name."""
    words: list[str] = []
    for argument, option, negative, flag, each in table:
        value = values[argument]
        if value is None:
            continue
        if flag:
            if not isinstance(value, bool):
                raise TypeError(f"{argument} must be True or False, not {value!r}")
            if value or negative:
                words.append("--" + (option if value else negative))
            continue
        given = _flat(argument, value)
        # A file whose name begins with a dash is no option.
        given = ["./" + word if word.startswith("-") and not _is_number(word) else word for word in given]
        if not option:
            words += given
            continue
        size = each or len(given) or 1
        for first in range(0, max(len(given), 1), size):
            words += ["--" + option, *given[first:first + size]]
    return words


def run(command: str, table: Table, values: Mapping[str, Any]) -> Result:
    """Runs a command with the values of its arguments."""
    words = command.split() + words_of(table, values)
    end = _bonetk.run_command([os.fsencode(word) for word in words], values["progress"])
    if end["exit"] != 0:
        raise {2: _bonetk.UsageError, 3: _bonetk.Error}.get(end["exit"], _bonetk.DataError)(end["error"])
    return Result(end["command"], end["text"], end["warnings"], end["outputs"], end["messages"])
