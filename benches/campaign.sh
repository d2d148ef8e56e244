#!/usr/bin/env bash
# Where the processor time of the examples' campaigns goes, with the code under test under coverage, as it is by default.
#
#   benches/campaign.sh [TESTS] [JOBS]     TESTS of each suite (default: 8); JOBS at once (default: 1)
#
# For each campaign: seconds of processor time by part, how many times as fast as real time it ran on one core, and how long it took.
# The engine alone, on the scene of a hand-over, beside whole steps of it: cargo bench -p hrdsl-sim --bench step -- steps_moving
set -euo pipefail
cd "$(dirname "$0")/.."
cargo build --release -p hrdsl --quiet
tests=${1:-8}
jobs=${2:-1}
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
for example in handover corridor delivery homecare; do
  # The first run installs what the code needs into the cache; it is not measured.
  target/release/hrdsl sim "examples/$example/scenario.hri" -n 1 -j "$jobs" -o "$out/warm-$example" --exit-zero >/dev/null
  echo "── $example: $tests tests of each suite, $jobs at once ──"
  target/release/hrdsl sim "examples/$example/scenario.hri" -n "$tests" -j "$jobs" -o "$out/$example" --exit-zero --timings |
    sed -n -e 's/^ran .*, in \(.* s of wall time\)$/\1/p' -e '/^processor time/,$p'
done
