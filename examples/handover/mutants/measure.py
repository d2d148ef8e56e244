#!/usr/bin/env python3
"""Runs the same tests on the robot's code and on each of its faults, and says which oracles notice which.

    python3 mutants/measure.py DEST [-n 4] [--hrdsl hrdsl] [--only NAME ...]

DEST gets the tests, the copies and their results; a fault whose results are there already is not run again, so that a run that was
broken off goes on. An oracle notices a fault if it objects to a test in which it has nothing against the original: a requirement
fails, the test leaves its prediction, or it ends in an error. DEST/table.json has what is printed, for machines.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys

import apply


def run(hrdsl, folder, arguments, out):
    """The results of the tests on the code in a folder; made in a folder of their own, which has its name when it is whole."""
    part = out + ".part"
    command = [hrdsl, "sim", os.path.join(folder, "scenario.hri"), *arguments, "-o", part, "--exit-zero", "--replays", "none"]
    shutil.rmtree(part, ignore_errors=True)
    done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode:
        sys.exit("%s\n%s" % (" ".join(command), done.stderr))
    os.rename(part, out)


def objections(out):
    """By test, what the oracles object to: names of requirements, `prediction`, `error`."""
    with open(os.path.join(out, "results.json"), encoding="utf-8") as file:
        results = json.load(file)
    found = {}
    for test in results["tests"]:
        objects = {verdict["requirement"] for verdict in test["verdicts"] if verdict["outcome"] == "fail"}
        if test.get("error") or test["ended"] == "error":
            objects.add("error")
        if (test.get("prediction") or {}).get("outcome") == "left":
            objects.add("prediction")
        found[test["name"]] = (test["method"], objects)
    return found


def noticed(original, faulty):
    """By oracle, the methods with a test in which it objects to the fault alone."""
    by_oracle = {}
    for test, (method, objects) in faulty.items():
        for oracle in objects - original[test][1]:
            by_oracle.setdefault(oracle, set()).add(method)
    return {oracle: sorted(methods) for oracle, methods in sorted(by_oracle.items())}


def header(name, field):
    """What the head of a patch says in a field, such as `Class`."""
    with open(os.path.join(apply.MUTANTS, name + ".patch"), encoding="utf-8") as file:
        lines = [line for line in file if line.startswith("# %s: " % field)]
    return lines[0].split(": ", 1)[1].strip() if lines else ""


def measured(options):
    """By fault, which oracles notice it, by which methods."""
    original = os.path.join(options.dest, "original")
    if not os.path.exists(original):
        run(options.hrdsl, apply.EXAMPLE, ["-n", str(options.count)], original)
    before = objections(original)
    table = {}
    chosen = options.only or apply.names()
    for at, name in enumerate(chosen, 1):
        copy, out = (os.path.join(options.dest, kind, name) for kind in ("copies", "results"))
        os.makedirs(os.path.dirname(out), exist_ok=True)
        if not os.path.exists(out):
            if not os.path.exists(copy):
                apply.make(name, copy)
            run(options.hrdsl, copy, [os.path.join(original, "tests")], out)
        table[name] = noticed(before, objections(out))
        oracles = ", ".join("%s (%s)" % (oracle, ", ".join(methods)) for oracle, methods in table[name].items())
        print("%d/%d %s: %s" % (at, len(chosen), name, oracles or "not noticed"), flush=True)
    return table


def summary(table):
    """How many faults each oracle notices, and each method."""
    lines = ["%d of %d faults are noticed" % (sum(bool(found) for found in table.values()), len(table))]
    kinds = {
        "a requirement": lambda oracle: oracle not in ("prediction", "error"),
        "a prediction": lambda oracle: oracle == "prediction",
        "an error": lambda oracle: oracle == "error",
    }
    for kind, is_it in kinds.items():
        lines.append("  by %s: %d" % (kind, sum(any(map(is_it, found)) for found in table.values())))
    for method in ("agents", "search", "random"):
        by_method = sum(any(method in methods for methods in found.values()) for found in table.values())
        lines.append("  in tests by %s: %d" % (method, by_method))
    missed = [name for name, found in table.items() if not found]
    lines += ["not noticed:"] + ["  %s (%s); expected: %s" % (n, header(n, "Class"), header(n, "Oracle")) for n in missed]
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description="Says which oracles notice which of the faults.")
    parser.add_argument("dest", help="where tests, copies and results are kept")
    parser.add_argument("-n", "--count", type=int, default=4, help="tests of each suite (default: 4)")
    parser.add_argument("--hrdsl", default="hrdsl", help="the program (default: hrdsl)")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="these faults alone")
    options = parser.parse_args()
    unknown = sorted(set(options.only or []) - set(apply.names()))
    if unknown:
        parser.error("there is no fault of the name %s" % unknown[0])
    os.makedirs(options.dest, exist_ok=True)
    table = measured(options)
    with open(os.path.join(options.dest, "table.json"), "w", encoding="utf-8") as file:
        json.dump(table, file, indent=1)
    print(summary(table))
    return 0


if __name__ == "__main__":
    sys.exit(main())
