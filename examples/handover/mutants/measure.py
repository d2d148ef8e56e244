#!/usr/bin/env python3
"""Runs the same tests on the robot's code and on each of its faults, and says which oracles notice which.

    python3 mutants/measure.py DEST [-n 4] [--hrdsl hrdsl] [--only NAME ...] [--json]

The tests are those of `adverse.hri` and as many of each suite as are asked for. DEST gets them, the copies and their results; a fault
whose results are there already is not run again, so that a run that was broken off goes on. An oracle notices a fault if it objects to
a test in which it has nothing against the original: a requirement fails, the test leaves its prediction, the code departs from its
model, or the test ends in an error. It does so for the right reason if the head of the fault names it. DEST/table.json has what is
printed, for machines.
"""

import argparse
import json
import os
import re
import shutil
import subprocess
import sys

import apply

METHODS = ("agents", "search", "random", "hand")

# What the head of a fault says of requirements that ought to notice it, by the requirement that asks for it.
SUBJECTS = {
    "R1": r"deadline (of|from).*release|decision to release",
    "R2": r"deadline (of|from).*release|decision to release|ready persons",
    "R3": r"[Rr]elease only|no leg falls|into a hand",
    "R4": r"put aside|request is answered",
    "R5": r"close on a hand",
    "R6": r"speed|energy",
    "R7": r"only with a leg",
    "R8": r"place of the (offer|hand-over)|distance",
    "R9": r"said to be put aside|when the hand is open",
    "R10": r"place (of|for) (the )?discarded",
    "R11": r"person holds|pressure|without a grip|no leg falls",
    "R12": r"decision (and|to) release|deadline from decision",
    "R13": r"deadline|window|how long",
    "R14": r"unanswered offer|after a timeout|after each offer",
    "R15": r"to rest",
    "R16": r"request is answered|run ends",
    "R17": r"contacts|no leg falls",
    "R18": r"only after a request",
    "R19": r"decision (agrees|is right)|each decision|says ready|sensors say",
    "R20": r"decision (agrees|is right)|each decision|says ready|sensors say",
    "R21": r"sensing only after",
    "R22": r"repeated requests|sensing window",
}


def run(hrdsl, arguments, out):
    """What the program makes; in a folder of its own, which has its name when it is whole."""
    part = out + ".part"
    shutil.rmtree(part, ignore_errors=True)
    command = [hrdsl, *arguments, "-o", part]
    done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode:
        sys.exit("%s\n%s" % (" ".join(command), done.stderr))
    os.rename(part, out)


def run_tests(options, folder, out):
    """The results of the tests on the code in a folder."""
    tests = os.path.join(options.dest, "tests")
    run(options.hrdsl, ["sim", os.path.join(folder, "scenario.hri"), tests, "--exit-zero", "--replays", "none"], out)


def objections(out):
    """By test, its method and what the oracles object to: names of requirements, `prediction`, `conformance`, `error`."""
    with open(os.path.join(out, "results.json"), encoding="utf-8") as file:
        results = json.load(file)
    found = {}
    for test in results["tests"]:
        objects = {verdict["requirement"] for verdict in test["verdicts"] if verdict["outcome"] == "fail"}
        if test.get("error") or test["ended"] == "error":
            objects.add("error")
        if (test.get("prediction") or {}).get("outcome") == "left":
            objects.add("prediction")
        if any(verdict["outcome"] == "departs" for verdict in test.get("conformance") or []):
            objects.add("conformance")
        found[test["name"]] = (test["method"], objects)
    return found


def noticed(original, faulty):
    """By oracle, the methods with a test in which it objects to the fault alone."""
    by_oracle = {}
    for test, (method, objects) in faulty.items():
        for oracle in objects - original[test][1]:
            by_oracle.setdefault(oracle, set()).add(method)
    return {oracle: sorted(methods) for oracle, methods in sorted(by_oracle.items())}


def recordings(out):
    """Those of a run, by their files."""
    folder = os.path.join(out, "traces")
    found = {}
    for name in sorted(os.listdir(folder)):
        with open(os.path.join(folder, name), "rb") as file:
            found[name] = file.read()
    return found


def header(name, field):
    """What the head of a patch says in a field, such as `Class`."""
    with open(os.path.join(apply.MUTANTS, name + ".patch"), encoding="utf-8") as file:
        head = "".join(line for line in file if line.startswith("#"))
    found = re.search(r"^# %s: (.*(?:\n#   .*)*)" % field, head, re.MULTILINE)
    return re.sub(r"\s*\n#\s*", " ", found.group(1)) if found else ""


def names_it(head, oracle):
    """Whether the head of a fault names an oracle, and of a requirement what it asks for."""
    if oracle in SUBJECTS:
        return "requirement" in head and re.search(SUBJECTS[oracle], head) is not None
    return oracle in head


def entry(before, same, name, out):
    """What the table has of a fault."""
    found = noticed(before, objections(out))
    head = header(name, "Oracle")
    return {
        "class": header(name, "Class"),
        "expected": head,
        "distinguished": recordings(out) != same,
        "noticed": found,
        "right": [oracle for oracle in found if names_it(head, oracle)],
    }


def measured(options):
    """By fault, which oracles notice it, by which methods."""
    tests, original = (os.path.join(options.dest, kind) for kind in ("tests", "original"))
    if not os.path.exists(tests):
        run(options.hrdsl, ["gen", os.path.join(apply.EXAMPLE, "scenario.hri"), "-n", str(options.count)], tests)
        shutil.copy(os.path.join(apply.EXAMPLE, "adverse.hri"), tests)
    if not os.path.exists(original):
        run_tests(options, apply.EXAMPLE, original)
    before, same = objections(original), recordings(original)
    table = {}
    chosen = options.only or apply.names()
    for at, name in enumerate(chosen, 1):
        copy, out = (os.path.join(options.dest, kind, name) for kind in ("copies", "results"))
        os.makedirs(os.path.dirname(out), exist_ok=True)
        if not os.path.exists(out):
            if not os.path.exists(copy):
                apply.make(name, copy)
            run_tests(options, copy, out)
        table[name] = entry(before, same, name, out)
        oracles = ", ".join("%s (%s)" % (oracle, ", ".join(by)) for oracle, by in table[name]["noticed"].items())
        nothing = "not noticed" if table[name]["distinguished"] else "not distinguished"
        print("%d/%d %s: %s" % (at, len(chosen), name, oracles or nothing), file=options.log, flush=True)
    return table


def kind(oracle):
    return "a requirement" if oracle in SUBJECTS else "conformance" if oracle == "conformance" else "%s %s" % (
        "an" if oracle == "error" else "a", oracle)


def share(part, whole):
    return "%d of %d (%.0f %%)" % (part, whole, 100.0 * part / whole if whole else 0.0)


def summary(table):
    """How many faults each oracle notices, and each method, and which ones nothing notices."""
    told = {name: row for name, row in table.items() if row["distinguished"]}
    rows = list(told.values())
    known = [row for row in rows if row["noticed"]]
    lines = [
        "%d faults, of which the tests cannot tell %d from the original" % (len(table), len(table) - len(told)),
        "%s of the others are noticed" % share(len(known), len(told)),
        "%s for a reason that the head of the fault gives" % share(sum(bool(row["right"]) for row in rows), len(told)),
    ]
    for name in ("a requirement", "conformance", "a prediction", "an error"):
        by = [row for row in known if name in map(kind, row["noticed"])]
        alone = sum(set(map(kind, row["noticed"])) == {name} for row in by)
        lines.append("  by %s: %s, %d by nothing else" % (name, share(len(by), len(told)), alone))
    for oracle in SUBJECTS:
        by = sum(oracle in row["noticed"] for row in rows)
        if by:
            lines.append("    %s: %d" % (oracle, by))
    for method in METHODS:
        by = sum(any(method in methods for methods in row["noticed"].values()) for row in rows)
        lines.append("  in tests by %s: %s" % (method, share(by, len(told))))
    apart = {
        "not noticed": lambda row: row["distinguished"] and not row["noticed"],
        "noticed, for another reason": lambda row: row["noticed"] and not row["right"],
        "not distinguished: the same recordings in all tests": lambda row: not row["distinguished"],
    }
    for what, is_it in apart.items():
        lines.append("%s:" % what)
        for name, row in table.items():
            if is_it(row):
                by = "by %s; " % ", ".join(row["noticed"]) if row["noticed"] else ""
                lines.append("  %s (%s): %sexpected: %s" % (name, row["class"], by, row["expected"]))
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description="Says which oracles notice which of the faults.")
    parser.add_argument("dest", help="where tests, copies and results are kept")
    parser.add_argument("-n", "--count", type=int, default=4, help="tests of each suite (default: 4)")
    parser.add_argument("--hrdsl", default="hrdsl", help="the program (default: hrdsl)")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="these faults alone")
    parser.add_argument("--json", action="store_true", help="print the table as JSON, and what is under way to stderr")
    options = parser.parse_args()
    options.log = sys.stderr if options.json else sys.stdout
    unknown = sorted(set(options.only or []) - set(apply.names()))
    if unknown:
        parser.error("there is no fault of the name %s" % unknown[0])
    os.makedirs(options.dest, exist_ok=True)
    table = measured(options)
    text = json.dumps(table, indent=1)
    with open(os.path.join(options.dest, "table.json"), "w", encoding="utf-8") as file:
        file.write(text + "\n")
    print(text if options.json else summary(table))
    return 0


if __name__ == "__main__":
    sys.exit(main())
