#!/usr/bin/env bash
# Examples/Population on Slurm: starts munge, slurmctld and slurmd on 127.0.0.1 in a temporary folder, and builds phantoms of
# about 2,000 cells by the array script, of which three must fail. In between a worker is killed and a task requeued. Then some
# of the array are submitted again, as they are and without the notes of what is done: nothing is built twice. At last the atlas is
# trained, and all is compared, byte for byte, with what the same scripts make without Slurm. With snakemake, twelve of the
# phantoms by that too. As root, with slurmctld, slurmd, slurm-client and munge installed; nothing is installed or left behind,
# and no other daemon is touched.
#
#   BONETK=PROGRAM Testing/Validation/slurm.sh [PHANTOMS [array]]     default: 200; array: without Snakemake
#
# What it measures goes to standard output, all else to standard error. Ends with 77 where Slurm is not there.
set -euo pipefail
project=$(cd "$(dirname "$0")/../.." && pwd)
population=$project/Examples/Population
subjects=${1:-200}
bonetk=$(command -v "${BONETK:-bonetk}") || { echo "$0: no program bonetk: set BONETK" >&2; exit 1; }
bonetk=$(realpath "$bonetk")
for program in munged slurmctld slurmd sbatch; do
  command -v $program > /dev/null || { echo "$0: $program is not installed" >&2; exit 77; }
done
[ "$(id -u)" = 0 ] || { echo "$0: only root may start Slurm's daemons" >&2; exit 77; }

# In a namespace of processes that ends with this script, were it killed, where that may be had.
if [ -z "${BONETK_IN_NAMESPACE:-}" ] && unshare --pid --fork --mount-proc true 2> /dev/null; then
  BONETK_IN_NAMESPACE=1 exec unshare --pid --fork --kill-child --mount-proc bash "$0" "$@"
fi

work=$(mktemp -d)
chmod 755 "$work"
begin=$SECONDS
say() { printf '%-64s %s\n' "$1" "$2"; }
lap() { # says how long it was since the last time
  say "$1" "$((SECONDS - begin)) s"
  begin=$SECONDS
}
fail() {
  echo "$0: $1" >&2
  tail -n 20 "$work"/*.log >&2 || true
  exit 1
}
daemons=()
clean() {
  scancel --user root 2> /dev/null || true
  # The last first: slurmctld and slurmd need munge to end in order.
  for ((i = ${#daemons[@]} - 1; i >= 0; --i)); do
    kill "${daemons[i]}" 2> /dev/null || true
    for ((wait = 0; wait < 50; ++wait)); do
      kill -0 "${daemons[i]}" 2> /dev/null || break
      sleep 0.1
    done
    kill -KILL "${daemons[i]}" 2> /dev/null || true
    wait "${daemons[i]}" 2> /dev/null || true
  done
  [ -n "${KEEP:-}" ] || rm -rf --one-file-system "$work"
}
trap clean EXIT
trap 'exit 143' TERM INT HUP
start() {
  "$@" > "$work/$1.log" 2>&1 &
  daemons+=($!)
}

# Slurm of one node.
mkdir "$work/munge" "$work/state" "$work/spool"
chmod 700 "$work/munge"
(umask 077; head -c 1024 /dev/urandom > "$work/munge/key")
chmod 755 "$work/munge"
export XDG_CACHE_HOME=$work/cache PYTHONDONTWRITEBYTECODE=1
processors=$(nproc)
memory=$(awk '/MemTotal/ { print int($2 / 1024) }' /proc/meminfo)
host=$(hostname -s)
read -r controller node < <(/usr/bin/python3 -c 'import socket
ports = [socket.socket() for _ in range(2)]
[port.bind(("127.0.0.1", 0)) for port in ports]
print(*(port.getsockname()[1] for port in ports))')
export SLURM_CONF=$work/slurm.conf
cat > "$SLURM_CONF" << END
ClusterName=population
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$controller
SlurmdPort=$node
SlurmUser=root
AuthType=auth/munge
AuthInfo=cred_expire=5,socket=$work/munge/socket
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
SchedulerParameters=sched_min_interval=100000,batch_sched_delay=0,sched_interval=1
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
ReturnToService=2
KillWait=2
MaxArraySize=10001
NodeName=$host NodeAddr=127.0.0.1 CPUs=$processors RealMemory=$memory State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
END
start munged --foreground --force --key-file "$work/munge/key" --socket "$work/munge/socket" \
  --pid-file "$work/munge/pid" --log-file "$work/munge/log" --seed-file "$work/munge/seed"
until [ -S "$work/munge/socket" ]; do kill -0 "${daemons[0]}" || fail "munged has ended"; sleep 0.2; done
start slurmctld -D -f "$SLURM_CONF"
start slurmd -D -f "$SLURM_CONF"
until [ "$(sinfo --noheader --format %t 2> /dev/null)" = idle ]; do
  for daemon in "${daemons[@]}"; do kill -0 "$daemon" || fail "a daemon has ended"; done
  [ $((SECONDS - begin)) -lt 60 ] || fail "Slurm does not come up"
  sleep 0.2
done
lap "Slurm is up"

# The phantoms; of three the label or a file is not there.
BONETK=$bonetk /usr/bin/python3 - "$project/Testing/Integration" "$work" "$subjects" << 'END'
import csv, multiprocessing, os, sys
sys.path.insert(0, sys.argv[1])
from bonetk_testing import phantom
os.chdir(sys.argv[2])
count = int(sys.argv[3])
def make(i):
    phantom("--subject", i, "--threads", 1, ct=f"ct{i}.nii.gz", labels=f"labels{i}.nii.gz", every=3)
with multiprocessing.Pool() as pool:
    pool.map(make, range(count), chunksize=1)
rows = [[f"s{i}", f"ct{i}.nii.gz", f"labels{i}.nii.gz", ""] for i in range(count)]
rows[count // 4][3] = "7"
rows[count // 2][1] = "gone.nii.gz"
rows[3 * count // 4][2] = "gone.nii.gz"
for name, part in (("subjects.csv", rows), ("twelve.csv", rows[:12])):
    with open(name, "w", newline="") as file:
        csv.writer(file).writerows([["subject", "ct", "labels", "label"], *part])
END
lap "$subjects phantoms"

# Notes the beginnings of builds, and their ends with what they said.
mkdir "$work/notes"
cat > "$work/bonetk" << END
#!/bin/sh
[ "\$1" = build ] || exec "$bonetk" "\$@"
echo "\$*" >> "\$NOTES/begun"
"$bonetk" "\$@" &
echo \$! > "\$NOTES/running.\$!"
trap 'kill -KILL \$!' TERM
wait \$!
code=\$?
rm -f "\$NOTES/running.\$!"
[ \$code -gt 128 ] && kill -KILL \$\$
[ \$code = 0 ] && echo "\$*" >> "\$NOTES/finished"
exit \$code
END
chmod +x "$work/bonetk"
# Slices and points are given, which takes half of the time that finding them for 2,000 cells does.
export BONETK="$work/bonetk" POPULATION=$population NOTES=$work/notes
build="--slice-step 15 --contour-spacing 30 --levels 0.5 --degree 1 --no-page"
register="--degree 1"
train="--no-page"
count() { [ -e "$NOTES/$1" ] && wc -l < "$NOTES/$1" || echo 0; }
submit() { # step, its options, tasks
  (cd "$work" && BONETK_OPTIONS=$2 sbatch --parsable --mem 500 --array "$3" "$population/array.sbatch" "$1" subjects.csv slurm)
}
through() { # waits for a job
  while [ -n "$(squeue --noheader --jobs "$1" 2> /dev/null)" ]; do
    [ $((SECONDS - begin)) -lt 3000 ] || fail "the array does not end"
    sleep 0.2
  done
}

job=$(submit build "$build" "1-$subjects")
until [ "$(count finished)" -ge 2 ]; do
  [ -n "$(squeue --noheader --jobs "$job")" ] || fail "the array has ended early"
  sleep 0.1
done
killed=
until [ -n "$killed" ]; do # a worker, in its work
  for note in "$NOTES"/running.*; do
    sleep 0.3
    kill -KILL "${note##*.}" 2> /dev/null && killed=1 && break
  done
  [ -n "$(squeue --noheader --jobs "$job")" ] || fail "no worker was there to be killed"
done
requeued=
until [ -n "$requeued" ]; do # a whole task, as when its node fails
  task=$(squeue --noheader --jobs "$job" --states running --format %i | head -n 1)
  [ -n "$task" ] && scontrol requeue "$task" && requeued=1
  [ -n "$(squeue --noheader --jobs "$job")" ] || fail "no task was there to be requeued"
done
through "$job"
lap "the array, on $processors processors"
say "builds begun, one killed and one requeued" "$(count begun)"
say "builds done" "$(count finished)"
[ "$(count finished)" -eq $((subjects - 3)) ] || fail "builds are lost, or were done twice"
[ "$(count begun)" -gt "$subjects" ] || fail "the killed worker was not started again"
[ "$(count begun)" -le $((subjects + 2)) ] || fail "builds were begun too often"

made() { (cd "$work/slurm/models" && stat --format '%n %Y %Z %s' ./*/* | sort); }
before=$(made)
step=$((subjects / 20 + 1))
some=1-$subjects:$step
through "$(submit build "$build" "$some")"
[ "$(count begun)" -le $((subjects + 2)) ] || fail "a second array builds"
lap "some twenty of the array again"
for ((subject = 0; subject < subjects; subject += step)); do rm "$work/slurm/outcomes/s$subject.csv"; done
through "$(submit build "$build" "$some")"
lap "again, without the notes of what is done"
[ "$(made)" = "$before" ] || fail "models were made twice"

through "$(submit register "$register" "1-$subjects")"
lap "each registered, on Slurm"
through "$(cd "$work" && BONETK_OPTIONS=$train sbatch --parsable --cpus-per-task "$processors" --mem 500 \
  "$population/train_after.sbatch" subjects.csv slurm)"
[ -e "$work/slurm/atlas.h5" ] || { cat "$work"/slurm-*.txt >&2; fail "there is no atlas"; }
lap "the atlas, on Slurm"

# The same without Slurm.
cd "$work"
array() { # step, its options
  seq "$subjects" | BONETK_OPTIONS=$2 BONETK=$bonetk xargs -P "$processors" -I NUMBER env SLURM_ARRAY_TASK_ID=NUMBER \
    bash "$population/array.sbatch" "$1" subjects.csv one >> one.log 2>&1 || fail "the array without Slurm fails"
}
array build "$build"
array register "$register"
BONETK_OPTIONS=$train BONETK=$bonetk bash "$population/train_after.sbatch" subjects.csv one >> one.log 2>&1 || fail "no atlas without Slurm"
lap "the same without Slurm"
[ "$(wc -l < slurm/failures.csv)" -eq 4 ] || fail "there are other failures than three"
same=0
for path in slurm/failures.csv slurm/atlas.h5 slurm/models/*/*.vtu slurm/registered/*.vtu; do
  cmp "$path" "one/${path#slurm/}" || fail "$path differs"
  same=$((same + 1))
done
say "files that are the same, byte for byte" $same

# Snakemake, which begins a Snakemake for each job.
if [ "${2:-}" != array ] && command -v snakemake > /dev/null; then
  snakemake --snakefile "$population/Snakefile" --nocolor --jobs 20 --cluster "sbatch --parsable --mem 500 --output /dev/null" \
    --cluster-status "$population/slurm_status.sh" --max-jobs-per-second 20 --max-status-checks-per-second 20 --config \
    subjects=twelve.csv results=snake bonetk="$bonetk" train_threads=1 "build=$build" "register=$register" "train=$train" > snakemake.log 2>&1 ||
    fail "snakemake fails"
  lap "twelve by Snakemake, on Slurm"
  for path in snake/models/*/*.vtu snake/registered/*.vtu; do cmp "$path" "one/${path#snake/}" || fail "$path differs"; done
fi
cat slurm/failures.csv
"$bonetk" info slurm/atlas.h5 | head -n 5
