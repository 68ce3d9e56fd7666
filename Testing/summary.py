#!/usr/bin/env python3
"""What failed in one or several runs of ctest, and a line of how many passed: summary.py JUNIT.xml...

Of each test that failed it prints the end of its output, as that is far up in the log of all of them. Ends with 1 where a
test failed, or a run left no file.
"""
import pathlib
import sys
import xml.etree.ElementTree

LINES = 40


def reason_of(case):
    """Why a test did not pass, as ctest says; empty where it passed or was skipped by itself."""
    failure, skipped = case.find("failure"), case.find("skipped")
    if failure is not None:
        return (failure.get("message") or "Failed") + "\n"
    message = skipped.get("message") if skipped is not None else ""
    return message + "\n" if message.startswith("Unable") else ""


def failures_of(path):
    """Failed tests' names and outputs, and how many tests there are; a run that left nothing counts as one that failed."""
    try:
        cases = list(xml.etree.ElementTree.parse(path).getroot().iter("testcase"))
    except (OSError, xml.etree.ElementTree.ParseError) as error:
        return [(str(path), str(error))], 1
    reasons = [(case, reason_of(case)) for case in cases]
    return [(case.get("name"), reason + (case.findtext("system-out") or "")) for case, reason in reasons if reason], len(cases)


def main(paths):
    failed, total = [], 0
    for path in paths:
        of_run, count = failures_of(path)
        failed += [(pathlib.Path(path).parent.name, name, output) for name, output in of_run]
        total += count
    for preset, name, output in failed:
        print(f"\n== failed ({preset}): {name}")
        print("\n".join(output.rstrip().splitlines()[-LINES:]))
    print(f"\n{100 * (total - len(failed)) // max(total, 1)}% tests passed, {len(failed)} tests failed out of {total}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
