#!/usr/bin/env bash
# The study with GNU parallel, on this machine's cores or with --sshlogin on several machines that share the folder:
#   ./prepare && ./parallel.sh && ./merge
# After a failure, run it again: whole shards are skipped.
set -euo pipefail
. "$(dirname "$0")/study"
export OUT TAXEL SEED STUDY="${STUDY:-small}" KILLED="${KILLED:-}"
seq "$SHARDS" | parallel "$@" "$HERE/shard" {}
