#!/usr/bin/env bash
# The study with GNU parallel, on this machine's cores, or with --sshlogin on several machines that share the folder:
#   ./prepare && ./parallel.sh && ./merge
# After a failure, run it again: completed shards are skipped.
set -euo pipefail
. "$(dirname "$0")/study"
export OUT TAXEL SEED STUDY="${STUDY:-small}" KILLED="${KILLED:-}"
# GNU parallel passes the variables that are named here to other machines.
variables=(--env OUT --env TAXEL --env TAXEL_CONFIG --env SEED --env STUDY --env KILLED)
seq "$SHARDS" | parallel --quote "${variables[@]}" "$@" "$HERE/shard" {}
