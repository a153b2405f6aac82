#!/usr/bin/env bash
#SBATCH --job-name=taxel
#SBATCH --array=1-8
#SBATCH --cpus-per-task=1
#SBATCH --output=out/%A-%a.log
# The study as a Slurm array job, with one task for each shard. In this folder:
#   ./prepare && sbatch --array=1-8 slurm.sh               # --array=1-1000 for STUDY=large
#   sbatch --dependency=singleton --job-name=taxel --wrap ./merge
# After a failure, submit the same job again: completed shards are skipped.
exec "${SLURM_SUBMIT_DIR:-.}/shard" "$SLURM_ARRAY_TASK_ID"
