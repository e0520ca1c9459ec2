#!/bin/bash
# A sweep of fakir as a job array: sbatch fakir-array.sh STUDY
#SBATCH --job-name=fakir
#SBATCH --array=1-40
#SBATCH --cpus-per-task=4
#SBATCH --mem=8G
#SBATCH --time=02:00:00
#SBATCH --output=fakir-%a.log
set -euo pipefail

study=${1:?name a study file: sbatch fakir-array.sh STUDY}
fakir sweep "$study" \
    --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT" \
    --threads "${SLURM_CPUS_PER_TASK:-1}" \
    --output "parts/$SLURM_ARRAY_TASK_ID" \
    --resume --quiet
