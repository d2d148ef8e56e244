#!/usr/bin/env python3
"""How many mutants `hrdsl mutate` tries in a second, against unit-sized tests of a program of 70 lines.

    python3 benches/mutants.py [HRDSL]     HRDSL is the program that is measured; without it, it is built: cargo build --release -p hrdsl

Each round runs `hrdsl mutate` with all mutants, and with one, for what it takes besides; the difference is what the mutants take: their compilation,
their runs, their judgement. Printed is the best of the rounds, since other programs on the machine can only add to it.
"""

import json
import os
import resource
import subprocess
import sys
import time

HERE = os.path.dirname(os.path.abspath(__file__))
ROUNDS = 5


def main():
    binary = os.path.abspath(sys.argv[1]) if len(sys.argv) > 1 else built()
    workers = len(os.sched_getaffinity(0))
    for jobs in sorted({1, workers}):
        rounds = [measured(binary, jobs) for _ in range(ROUNDS)]
        processor, wall = min(r[0] for r in rounds), min(r[1] for r in rounds)
        print("%d at once: %.0f mutants in a second, %.1f ms of processor time each" % (jobs, 1 / wall, processor * 1000))


def built():
    subprocess.run(["cargo", "build", "--release", "-p", "hrdsl", "--quiet"], cwd=HERE, check=True)
    told = subprocess.run(
        ["cargo", "metadata", "--format-version", "1", "--no-deps"], cwd=HERE, check=True, stdout=subprocess.PIPE
    ).stdout
    return os.path.join(json.loads(told)["target_directory"], "release", "hrdsl")


def measured(binary, jobs):
    """Seconds of processor time and of wall time for a mutant."""
    one, all_of_them = mutate(binary, jobs, "--sample", "1"), mutate(binary, jobs)
    more = all_of_them["ran"] - one["ran"]
    return [(all_of_them[name] - one[name]) / more for name in ("processor", "wall")]


def mutate(binary, jobs, *options):
    folder = os.path.join(HERE, "mutants")
    words = [binary, "mutate", "scenario.hri", "tests.hri", "-j", str(jobs), "--json", *options]
    before, begun = processor_time(), time.monotonic()
    done = subprocess.run(words, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    wall, processor = time.monotonic() - begun, processor_time() - before
    if done.returncode:
        sys.exit(done.stderr.decode())
    found = json.loads(done.stdout)
    if [sentinel["fate"] for sentinel in found["sentinels"]] != ["killed"]:
        sys.exit("the sentinel lives: the tests measure nothing")
    return {"ran": sum(mutant["ran"] > 0 for mutant in found["mutants"]), "processor": processor, "wall": wall}


def processor_time():
    """Of all that has been started and has ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


if __name__ == "__main__":
    main()
