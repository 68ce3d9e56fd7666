#!/usr/bin/env python3
"""What becomes of each subject: its model, that on the standard's topology, and the table of those that failed.

    population.py build    SUBJECTS.csv NAME|NUMBER --results FOLDER [--attempt N] [--attempts N] [--again] -- BONETK OPTIONS
    population.py standard SUBJECTS.csv             --results FOLDER [--level N]
    population.py register SUBJECTS.csv NAME|NUMBER --results FOLDER [--level N] [--attempt ...] -- BONETK OPTIONS
    population.py collect  SUBJECTS.csv             --results FOLDER [--level N]

`build` runs `BONETK build` for one subject, named, or the table's first, second, … It writes FOLDER/outcomes/NAME.csv and
ends with 0 once nothing more is to be tried: the model is there, or the data (exit code 1) or the options (2) are bad, or
`--attempts` were made. Otherwise (no space, no memory, a kill, no program) it ends with the build's exit code: try again.
`standard` makes FOLDER/standard.vtu, a copy of the table's first model, where there is none; `register`, once all builds are
through, does so too, and then runs `BONETK register subject` likewise, which writes FOLDER/registrations/NAME.csv.
`collect` writes FOLDER/failures.csv, FOLDER/doubts.csv of what `build` doubted of the others, and FOLDER/subjects.txt for
`bonetk train`.
"""
import argparse
import csv
import filecmp
import hashlib
import io
import json
import os
import re
import shutil
import subprocess
import sys

FINAL = (0, 1, 2)  # exit codes of bonetk that another attempt would not change


def read_subjects(path):
    """The table's rows by subject, in its order; file names made relative to the current folder."""
    with open(path, newline="", encoding="utf-8-sig") as file:
        rows = list(csv.DictReader(file, skipinitialspace=True))
    subjects = {}
    for number, row in enumerate(rows, 1):
        row = {key: (value or "").strip() for key, value in row.items() if key}
        missing = [column for column in ("subject", "ct", "labels") if not row.get(column)]
        if missing:
            sys.exit(f"{path}: subject number {number} has no {' and no '.join(missing)}; columns are subject, ct, labels, label")
        name = row["subject"]
        if not re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_.-]*", name):
            sys.exit(f"{path}: subject '{name}' names files: use letters, digits, '_', '-' and '.' alone")
        if name in subjects:
            sys.exit(f"{path}: subject '{name}' is there twice")
        for column in ("ct", "labels"):
            row[column] = os.path.join(os.path.dirname(path), row[column])
        subjects[name] = row
    return subjects


def last_status(path):
    """The last whole line of a status file; empty where there is none."""
    status = {}
    try:
        with open(path, encoding="utf-8") as file:
            for line in file:
                status = json.loads(line)
    except (OSError, ValueError):
        pass
    return status


def reason(code, status, log):
    """Why a build has failed: the program's own error, or where it was when it was killed."""
    if "error" in status:
        return status["error"]
    if code is None or code > 128:
        how = "no end" if code is None else f"killed by signal {code - 128}"
        return f"{how} in the stage {status.get('stage', 'start')}"
    with open(log, encoding="utf-8", errors="replace") as file:  # bad options: there is no status yet
        lines = file.read().strip().splitlines()
    return lines[-1].removeprefix("bonetk build: ") if lines else f"exit code {code} without an error"


def paths(results, name, what="build"):
    """Of a subject's build, or of its registration: outcome, status, log, and the folder or file that it makes."""
    if what == "build":
        parts = (("outcomes", name + ".csv"), ("status", name + ".jsonl"), ("logs", name + ".txt"), ("models", name))
    else:
        parts = (("registrations", name + ".csv"), ("status", name + ".registration.jsonl"),
                 ("logs", name + ".registration.txt"), ("registered", name + ".vtu"))
    return [os.path.join(results, *part) for part in parts]


def write(path, text):
    """All of a file at once."""
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path + ".part", "w", encoding="utf-8", newline="") as file:
        file.write(text)
    os.replace(path + ".part", path)


def write_rows(path, rows):
    table = io.StringIO()
    csv.writer(table, lineterminator="\n").writerows(rows)
    write(path, table.getvalue())


def run(row, options, arguments):
    """One attempt at a build or a registration; returns the exit code, 0 also for an outcome that is final."""
    outcome, status, log, made = paths(options.results, row["subject"], options.what)
    for path in (outcome, status, log, made):
        os.makedirs(os.path.dirname(path), exist_ok=True)
    code = None  # of an attempt that took all of its job along
    if options.attempt <= options.attempts:
        if os.path.exists(status):
            os.remove(status)
        program, *others = options.command
        command = [program, *arguments, *others, "-o", made, "--status", status]
        with open(log, "w", encoding="utf-8") as file:
            try:
                code = subprocess.run(command, stdout=file, stderr=file, check=False).returncode
            except OSError as error:
                print(error, file=file, flush=True)
                code = 127
        code = 128 - code if code < 0 else code
    if code not in FINAL and options.attempt < options.attempts:
        print(f"{row['subject']}: {reason(code, last_status(status), log)}: try again", file=sys.stderr)
        return code or 1
    why = "" if code == 0 else reason(code, last_status(status), log)
    why = f"registration: {why}" if why and options.what == "register" else why
    write_rows(outcome, [[row["subject"], "" if code is None else code, why]])
    return 0


def build(row, options):
    registration = paths(options.results, row["subject"], "register")[0]
    if os.path.exists(registration):  # of an earlier model
        os.remove(registration)
    label = ["--label", row["label"]] if row.get("label") else []
    return run(row, options, ["build", row["ct"], "--labels", row["labels"], *label])


def result(results, name, what):
    """What came of a subject's build or registration: name, exit code and reason."""
    outcome, status, _, _ = paths(results, name, what)
    if not os.path.exists(outcome):
        return [name, "", reason(None, last_status(status), None)]
    with open(outcome, newline="", encoding="utf-8") as file:
        return next(csv.reader(file))


def model(options, name):
    return os.path.join(paths(options.results, name)[-1], f"model_L{options.level}.vtu")


def first_built(subjects, options):
    return next((name for name in subjects if result(options.results, name, "build")[1] == "0"), None)


def standard(subjects, options):
    """The standard model. It stays when subjects come, so that all registered models have its topology."""
    path = os.path.join(options.results, "standard.vtu")
    first = first_built(subjects, options)
    if first and not os.path.exists(path):
        part = f"{path}.{os.getpid()}.part"  # other jobs may do the same
        shutil.copyfile(model(options, first), part)
        os.replace(part, path)
    return path


def register(subjects, row, options):
    built = result(options.results, row["subject"], "build")
    if built[1] != "0":
        write_rows(paths(options.results, row["subject"], "register")[0], [built])
        return 0
    return run(row, options, ["register", "subject", standard(subjects, options), model(options, row["subject"]), "--ct", row["ct"]])


def doubts(results, name):
    """Why a subject's CT or label map may be a wrong one, as its build says."""
    try:
        with open(os.path.join(paths(results, name)[-1], "report.json"), encoding="utf-8") as file:
            return json.load(file).get("doubts", [])
    except OSError:
        return []


def collect(subjects, options):
    """The tables of failures and of doubts, and the list for the atlas."""
    failures, doubted, used, models = [], [], [], hashlib.sha256()
    for name in subjects:
        found = result(options.results, name, "register")
        if found[1] != "0":
            failures.append(found)
            continue
        mesh = paths(options.results, name, "register")[-1]
        with open(mesh, "rb") as file:
            models.update(file.read())
        used.append(os.path.relpath(mesh, options.results))
        doubted += [[name, doubt] for doubt in doubts(options.results, name)]
    write_rows(os.path.join(options.results, "doubts.csv"), [["subject", "doubt"], *doubted])
    write_rows(os.path.join(options.results, "failures.csv"), [["subject", "exit", "reason"], *failures])
    # With the checksum the list changes when a model does, so that the atlas is made anew.
    write(os.path.join(options.results, "subjects.txt"), "\n".join([f"# models {models.hexdigest()}", *used, ""]))
    print(f"{len(used)} models, {len({name for name, _ in doubted})} of them in doubt, {len(failures)} failures")
    first = first_built(subjects, options)
    if first and not filecmp.cmp(standard(subjects, options), model(options, first), shallow=False):
        print(f"the atlas has the topology of {options.results}/standard.vtu, which is not the present model of {first}: to take"
              " that, remove standard.vtu and the folder registrations, and begin again", file=sys.stderr)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True, dest="what")
    for what in ("build", "standard", "register", "collect"):
        command = commands.add_parser(what)
        command.add_argument("subjects")
        if what in ("build", "register"):
            command.add_argument("subject")
            command.add_argument("--attempt", type=int, default=1)
            command.add_argument("--attempts", type=int, default=3)
            command.add_argument("--again", action="store_true", help="though there is an outcome")
            command.add_argument("command", nargs="+", metavar="BONETK OPTIONS")
        command.add_argument("--level", type=int, default=1)
        command.add_argument("--results", required=True)
    options = parser.parse_args()
    subjects = read_subjects(options.subjects)
    if options.what == "collect":
        return collect(subjects, options)
    if options.what == "standard":
        standard(subjects, options)
        return 0
    row = subjects.get(options.subject)
    if row is None:
        if not options.subject.isdecimal() or not 1 <= int(options.subject) <= len(subjects):
            sys.exit(f"{options.subjects}: there is no subject {options.subject}")
        row = list(subjects.values())[int(options.subject) - 1]
    if os.path.exists(paths(options.results, row["subject"], options.what)[0]) and not options.again:
        return 0
    return build(row, options) if options.what == "build" else register(subjects, row, options)


if __name__ == "__main__":
    sys.exit(main())
