#!/usr/bin/env python3
"""Writes bonetk/commands.py, a function for each command of the program, from the program's own tables of options.

usage: generate_commands.py FOLDER_OF_THE_EXTENSION FILE
"""
import keyword
import re
import sys
import textwrap

WIDTH = 120
HEAD = '''"""The commands of the program bonetk as functions, from files to files. Made from the program's options: do not edit.

Each writes the same bytes as the program and returns a ``Result``. Inputs come first, options by keyword; None leaves an
option at its default. ``progress`` is called as ``progress(stage, share)`` on the calling thread, the share going from 0
to 1. An exception that it raises, or Ctrl-C, stops the work and comes out; then no output is written. One command runs
at a time in a process. Raises ``bonetk.UsageError`` where the program ends with 2, ``bonetk.DataError`` where it ends
with 1, ``bonetk.Error``, which both are, where it ends with 3 (no space on the disk, or no memory).
"""
from __future__ import annotations

from typing import TYPE_CHECKING

from ._call import Result, run as _run

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Literal, Optional, Union

    from ._call import Path, Progress, Table
'''


def argument_of(name):
    """An option's name as that of an argument."""
    name = name.replace("-", "_")
    return name + "_" if keyword.iskeyword(name) else name


def type_of(option):
    """The type of one value of an option."""
    kind = option["type"]
    if option["flag"]:
        return "bool"
    if kind in ("FLOAT", "NUMBER"):
        return "float"
    if kind in ("INT", "UINT"):
        return "int"
    if kind == "NAME":
        return "str"
    if re.fullmatch(r"[a-z]+(\|[a-z]+)+", kind):
        return "Literal[" + ", ".join(f'"{choice}"' for choice in kind.split("|")) + "]"
    if kind == "VALUE|NAME" or option["name"] == "region":
        return "Union[str, int]"
    return "Path" if kind in ("TEXT", "FILE") else "str"


def annotation_of(option):
    """The type of an argument: a value, a sequence, or sequences of several values each."""
    kind = type_of(option)
    if option["most"] in (0, 1) or option["flag"]:
        return kind
    if option["each"] > 1:
        return f"Union[Sequence[{kind}], Sequence[Sequence[{kind}]]]"
    return f"Sequence[{kind}]" if option["least"] > 1 else f"Union[{kind}, Sequence[{kind}]]"


def signature_of(command, options):
    name = argument_of(command["name"].replace(" ", "_"))
    arguments = []
    keywords = False
    for option in sorted(options, key=lambda o: (not o["positional"], not o["required"])):
        if not option["positional"] and not keywords:
            arguments.append("*")
            keywords = True
        argument, kind = argument_of(option["name"]), annotation_of(option)
        plain_flag = option["flag"] and not option["negative"]
        arguments.append(f"{argument}: {kind}" if option["required"] else
                         f"{argument}: bool = False" if plain_flag else f"{argument}: Optional[{kind}] = None")
    arguments.append("progress: Optional[Progress] = None")
    return f"def {name}(\n    " + ",\n    ".join(arguments) + ",\n) -> Result:\n"


def text_of(help_text, names):
    """Help with the names of arguments in place of those of options."""
    text = re.sub(r"--([a-z0-9][a-z0-9-]*)", lambda m: f"``{argument_of(m[1])}``" if m[1] in names else m[0], help_text)
    return text.replace("\\", "\\\\").replace('"""', "'''")


def docstring_of(command, options):
    names = {option["name"] for option in options}
    lines = [f'"""{text_of(command["help"], names)}.', "", f"As ``bonetk {command['name']}``.", ""]
    for option in options:
        lines += textwrap.wrap(f"{argument_of(option['name'])}: {text_of(option['help'], names)}", WIDTH - 4,
                               subsequent_indent="    ", break_on_hyphens=False, break_long_words=False)
    lines += ["progress: called as progress(stage, share)", '"""']
    return "".join("    " + line + "\n" if line else "\n" for line in lines)


def table_of(command, options):
    rows = []
    for option in options:
        name = "" if option["positional"] else option["name"]
        rows.append(f"    ({argument_of(option['name'])!r}, {name!r}, {option['negative']!r}, {option['flag']}, "
                    f"{option['each']}),\n")
    return f"_{command['name'].replace(' ', '_').upper()}: Table = (\n" + "".join(rows) + ")\n"


def module_of(commands):
    functions = []
    for command in commands:
        options = command["options"]
        table = "_" + command["name"].replace(" ", "_").upper()
        functions.append(f"\n\n{table_of(command, options)}\n\n{signature_of(command, options)}"
                         f"{docstring_of(command, options)}    return _run({command['name']!r}, {table}, locals())\n")
    names = sorted(argument_of(command["name"].replace(" ", "_")) for command in commands)
    listed = "\n__all__ = [\n    \"Result\",\n" + "".join(f'    "{name}",\n' for name in names) + "]\n"
    return HEAD + listed + "".join(functions)


def main():
    folder, path = sys.argv[1:]
    sys.path.insert(0, folder)
    import _bonetk
    with open(path, "w", encoding="utf-8") as file:
        file.write(module_of(_bonetk.describe_commands()))


if __name__ == "__main__":
    main()
