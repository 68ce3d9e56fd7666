#!/usr/bin/env bash
# Tells Snakemake what became of a Slurm job (--cluster-status): without it, Snakemake waits for ever for a job that Slurm ended.
if ! job=$(scontrol --oneliner show job "$1" 2>&1); then
  case $job in
    *"Invalid job id"*) echo failed ;;
    *) echo running ;; # the controller did not answer: ask again
  esac
  exit
fi
case $(grep -o 'JobState=[A-Z_]*' <<< "$job") in
  *=COMPLETED) echo success ;;
  *=PENDING | *=CONFIGURING | *=RUNNING | *=COMPLETING | *=SUSPENDED | *=STOPPED | *=REQUEUED | *=RESIZING) echo running ;;
  *) echo failed ;;
esac
