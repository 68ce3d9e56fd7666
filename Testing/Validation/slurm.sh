#!/usr/bin/env bash
# Examples/Population on Slurm: starts munge, slurmctld and slurmd on 127.0.0.1 in a temporary folder, builds phantoms of about
# 2,000 cells by Snakemake with --cluster "sbatch --parsable", of which three must fail, kills a worker and cancels a job in
# between, trains the atlas, and compares all with what the same does without Slurm, byte for byte. As root, with snakemake,
# slurmctld, slurmd, slurm-client and munge installed; nothing is installed or left behind, and no other daemon is touched.
#
#   BONETK=PROGRAM Testing/Validation/slurm.sh [PHANTOMS]     default: 200
#
# What it measures goes to standard output, all else to standard error.
set -euo pipefail
project=$(cd "$(dirname "$0")/../.." && pwd)
population=$project/Examples/Population
subjects=${1:-200}
bonetk=$(command -v "${BONETK:-bonetk}") || { echo "$0: no program bonetk: set BONETK" >&2; exit 1; }
say() { printf '%-64s %s\n' "$1" "$2"; }
fail() {
  echo "$0: $1" >&2
  tail -n 20 "$work"/*.log >&2 || true
  exit 1
}
for program in munged slurmctld slurmd sbatch snakemake; do
  command -v $program > /dev/null || { echo "$0: $program is not installed" >&2; exit 1; }
done

work=$(mktemp -d)
chmod 755 "$work"
daemons=()
clean() {
  scancel --user root 2> /dev/null || true
  # The last first: slurmctld and slurmd need munge to end in order.
  for ((i = ${#daemons[@]} - 1; i >= 0; --i)); do
    kill "${daemons[i]}" 2> /dev/null || true
    wait "${daemons[i]}" 2> /dev/null || true
  done
  [ -n "${KEEP:-}" ] || rm -rf --one-file-system "$work"
}
trap clean EXIT
start() {
  local log=$work/$1.log
  "$@" > "$log" 2>&1 &
  daemons+=($!)
}

# Slurm of one node.
mkdir "$work/munge" "$work/state" "$work/spool"
chmod 700 "$work/munge"
(umask 077; head -c 1024 /dev/urandom > "$work/munge/key")
chmod 755 "$work/munge"
export XDG_CACHE_HOME=$work/cache
processors=$(nproc)
host=$(hostname -s)
export SLURM_CONF=$work/slurm.conf
cat > "$SLURM_CONF" << END
ClusterName=population
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=16817
SlurmdPort=16818
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$work/munge/socket
CredType=cred/munge
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
ReturnToService=2
KillWait=5
NodeName=$host NodeAddr=127.0.0.1 CPUs=$processors State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
END
start munged --foreground --force --key-file "$work/munge/key" --socket "$work/munge/socket" \
  --pid-file "$work/munge/pid" --log-file "$work/munge/log" --seed-file "$work/munge/seed"
until [ -S "$work/munge/socket" ]; do kill -0 "${daemons[0]}" || fail "munged has ended"; sleep 0.2; done
start slurmctld -D -f "$SLURM_CONF"
start slurmd -D -f "$SLURM_CONF"
until [ "$(sinfo --noheader --format %t 2> /dev/null)" = idle ]; do
  for daemon in "${daemons[@]}"; do kill -0 "$daemon" || fail "a daemon has ended"; done
  sleep 0.5
done

# The phantoms; of three the label or a file is not there.
begin=$SECONDS
BONETK=$bonetk PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 - "$project/Testing/Integration" "$work" "$subjects" << 'END'
import csv, os, sys
sys.path.insert(0, sys.argv[1])
from bonetk_testing import phantom
os.chdir(sys.argv[2])
count = int(sys.argv[3])
rows = []
for i in range(count):
    ct, labels = f"ct{i}.nii.gz", f"labels{i}.nii.gz"
    phantom("--subject", i, ct=ct, labels=labels, every=3)
    rows.append([f"s{i}", ct, labels, ""])
rows[count // 4][3] = "7"
rows[count // 2][1] = "gone.nii.gz"
rows[3 * count // 4][2] = "gone.nii.gz"
with open("subjects.csv", "w", newline="") as file:
    csv.writer(file).writerows([["subject", "ct", "labels", "label"], *rows])
END
say "$subjects phantoms" "$((SECONDS - begin)) s"

# Notes the builds' beginnings.
cat > "$work/bonetk" << END
#!/bin/sh
echo "\$*" >> calls.txt
exec "$bonetk" "\$@"
END
chmod +x "$work/bonetk"
population() {
  mkdir -p "$work/$1"
  (cd "$work/$1" && shift && PYTHONDONTWRITEBYTECODE=1 exec snakemake --snakefile "$population/Snakefile" --nocolor "$@" \
    --config subjects=../subjects.csv bonetk=../bonetk train_threads=1 "build=--tetrahedra 2000 --degree 1 --no-page" \
    "train=--degree 1 --no-page") > "$work/snakemake.log" 2>&1
}
on_slurm() {
  population slurm --jobs 50 --cluster "sbatch --parsable" --cluster-status "$population/slurm_status.sh" \
    --max-jobs-per-second 20 --max-status-checks-per-second 20
}
builds() { grep -c '^build' "$work/$1/calls.txt" || true; }
running() { # a build of this script
  local process
  for process in $(pgrep -f "^$bonetk build "); do
    [ "$(readlink "/proc/$process/cwd")" != "$work/slurm" ] || { echo "$process"; return; }
  done
}

begin=$SECONDS
on_slurm &
whole=$!
# One build's process is killed, and later another one's whole job cancelled.
until [ "$(find "$work/slurm/results/outcomes" -name "*.csv" 2> /dev/null | wc -l)" -ge 2 ]; do
  kill -0 $whole 2> /dev/null || fail "snakemake has ended early"
  sleep 0.2
done
until worker=$(running) && [ -n "$worker" ] && kill -KILL "$worker"; do
  kill -0 $whole 2> /dev/null || fail "no worker was there to be killed"
  sleep 0.05
done
sleep 2
until job=$(squeue --noheader --states running --format %A | head -n 1) && [ -n "$job" ]; do
  kill -0 $whole 2> /dev/null || fail "no job was there to be cancelled"
  sleep 0.05
done
scancel "$job"
wait $whole || fail "snakemake on Slurm fails"
say "on Slurm, $processors processors" "$((SECONDS - begin)) s"
say "builds begun, one of them killed" "$(builds slurm)"
[ "$(builds slurm)" -le $((subjects + 2)) ] || fail "builds were done twice"
[ "$(builds slurm)" -gt "$subjects" ] || fail "the killed worker was not started again"

before=$(builds slurm)
on_slurm || fail "a second run fails"
[ "$(builds slurm)" -eq "$before" ] || fail "a second run builds"

begin=$SECONDS
population one --cores "$processors" || fail "snakemake without Slurm fails"
say "without Slurm" "$((SECONDS - begin)) s"

cd "$work"
[ "$(wc -l < slurm/results/failures.csv)" -eq 4 ] || fail "there are other failures than three"
models=0
for file in failures.csv atlas.h5 models/*/*.vtu; do
  for path in slurm/results/$file; do
    cmp "$path" "one/results/${path#slurm/results/}" || fail "$path differs"
    models=$((models + 1))
  done
done
say "files that are the same, byte for byte" $models
cat slurm/results/failures.csv
"$bonetk" info slurm/results/atlas.h5 | head -n 5
