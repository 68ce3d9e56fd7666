#!/usr/bin/env python3
"""Writes the type stubs of the extension: those of bonetk/_bonetk.pyi with the properties of each filter, which the
extension knows by the filters' tables of parameters.

usage: generate_stubs.py FOLDER_OF_THE_EXTENSION STUBS_BY_HAND FILE
"""
import sys


def members_of(filter_class):
    """The lines of the class."""
    lines = ["    def __init__(self) -> None: ...\n"]
    for name, annotation in filter_class._members.items():
        if annotation.startswith("-> "):
            lines += ["    @property\n", f"    def {name}(self) {annotation}: ...\n"]
        else:
            lines.append(f"    {name}: {annotation}\n")
    return "".join(lines)


def stubs_of(extension, text):
    for name, value in sorted(vars(extension).items()):
        if hasattr(value, "_members"):
            head = f"class {name}(ProcessObject):\n"
            if head not in text:
                text += "\n" + head
            text = text.replace(head, head + members_of(value))
    return text


def main():
    folder, by_hand, path = sys.argv[1:]
    sys.path.insert(0, folder)
    import _bonetk
    with open(by_hand, encoding="utf-8") as file:
        text = file.read()
    with open(path, "w", encoding="utf-8") as file:
        file.write(stubs_of(_bonetk, text))


if __name__ == "__main__":
    main()
