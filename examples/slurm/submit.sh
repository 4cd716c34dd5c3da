#!/bin/sh
# `submit.sh CAMPAIGN VALUES REPORT [PARTS]`: the parts, and after them the report, which tells the parts that are missing.
set -eu
export CAMPAIGN="$1" VALUES="$2" REPORT="$3" PARTS="${4:-8}"
here=$(dirname "$0")
job=$(sbatch --parsable --array="0-$((PARTS - 1))" "$here/reduce.sbatch")
sbatch --parsable --dependency="afterany:$job" "$here/judge.sbatch"
