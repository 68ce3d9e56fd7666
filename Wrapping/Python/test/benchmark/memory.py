"""Peak resident memory of a build from Python, by bonetk.commands.build and by bonetk.build in memory, beside the program's.

memory.py PROGRAM: on an analytic femur, and on the hip of $BONETK_DATA where that is set. Python must take 1.1 times the
program's at the most; the exit code is 1 where it takes more.
"""
import os
import subprocess
import sys
import tempfile

MOST = 1.1
HIP = ("hip_ct.nii.gz", "hip_labels.nii.gz")
HIP_LABEL = "2"  # the hip bone
COMMAND = """
import sys, bonetk
ct, labels, label, output = sys.argv[1:]
bonetk.commands.build(ct, labels=labels, label=label or None, output=output, no_page=True)
"""
MEMORY = """
import sys, bonetk
ct, labels, label, _ = sys.argv[1:]
bonetk.build(ct, labels, **({"label": int(label)} if label else {}))
"""


def peak(arguments):
    """MiB of a process."""
    process = subprocess.Popen(arguments, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        sys.exit(f"{arguments[:2]} ended with {process.returncode}")
    return usage.ru_maxrss / 1024


def compare(name, program, ct, labels, label, folder):
    output = os.path.join(folder, name)
    chosen = ["--label", label] if label else []
    wanted = peak([program, "build", ct, "--labels", labels, *chosen, "-o", output, "--no-page", "--quiet"])
    line, worst = f"{name}: the program {wanted:.0f} MiB", 0.0
    for what, script in (("commands.build", COMMAND), ("build", MEMORY)):
        found = peak([sys.executable, "-c", script, ct, labels, label, output + what])
        line += f", {what} {found:.0f} MiB ({found / wanted:.2f})"
        worst = max(worst, found / wanted)
    print(line, flush=True)
    return worst


def main():
    program = sys.argv[1]
    with tempfile.TemporaryDirectory() as folder:
        ct, labels = (os.path.join(folder, name) for name in ("ct.nii.gz", "labels.nii.gz"))
        subprocess.run([program, "phantom", "-o", ct, "--labels", labels], check=True, stdout=subprocess.DEVNULL)
        worst = compare("femur", program, ct, labels, "", folder)
        data = os.environ.get("BONETK_DATA")
        if data:
            hip = os.path.join(data, "hip_ct")
            ct, labels = (os.path.join(hip, name) for name in HIP)
            worst = max(worst, compare("hip", program, ct, labels, HIP_LABEL, folder))
    sys.exit(worst > MOST)


if __name__ == "__main__":
    main()
