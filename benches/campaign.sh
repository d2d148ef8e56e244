#!/usr/bin/env bash
# Times the handover campaign: 160 tests of 300 s for each method, under code coverage.
#
#   benches/campaign.sh [JOBS]        default: as many as there are cores
set -euo pipefail
cd "$(dirname "$0")/.."
cargo build --release -p hrdsl --quiet
jobs=${1:-$(nproc)}
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
# The first run installs coverage.py into the cache; it is not measured.
target/release/hrdsl sim examples/handover/scenario.hri --suite random_tests -n 1 -o "$out/warm" --exit-zero >/dev/null
for suite in bdi_tests ta_tests random_tests; do
  start=$(date +%s.%N)
  target/release/hrdsl sim examples/handover/scenario.hri --suite "$suite" -j "$jobs" -o "$out/$suite" --exit-zero >/dev/null
  end=$(date +%s.%N)
  tests=$(ls "$out/$suite/traces" | wc -l)
  echo "$suite: $tests tests in $(awk "BEGIN { print $end - $start }") s of wall time, $jobs jobs"
done
