#!/usr/bin/env python3
"""Compares the results of two systems that were run on the same tests.

    hrdsl sim scenario.hri -o a
    hrdsl sim scenario.hri --system with_rospy/system.hri -o b
    python3 with_rospy/compare.py a b [--tolerance SECONDS] [--all]

A paragraph for each test whose verdicts differ: those requirements, and where the two recordings part, which is the first
event that one has and the other has not, or has more than the tolerance earlier or later. With `--all`, the same of tests
whose verdicts agree, if their recordings part. The exit code is 0 if all verdicts agree, and 1 if not.
"""

import argparse
import json
import os
import sys


def tests_of(folder):
    """The tests of a run by their names."""
    with open(os.path.join(folder, "results.json"), encoding="utf-8") as file:
        return {test["name"]: test for test in json.load(file)["tests"]}


def verdicts(test):
    """The outcome of each requirement; of a test that broke off, the error."""
    if test["error"]:
        return {"error": json.dumps(test["error"])}
    return {verdict["requirement"]: verdict["outcome"] for verdict in test["verdicts"]}


def events_of(folder, name):
    """The events of a recording: time, and name with arguments."""
    events = []
    with open(os.path.join(folder, "traces", name + ".jsonl"), encoding="utf-8") as file:
        for line in file:
            entry = json.loads(line)
            if "event" in entry:
                args = ", ".join("%s: %s" % (key, json.dumps(value)) for key, value in entry.get("args", {}).items())
                events.append((entry["t"], "%s(%s)" % (entry["event"], args)))
    return events


def shown(event):
    return "nothing more" if event is None else "%.3f s %s" % event


def simultaneous(events, at):
    """The events of one instant, whose order says nothing."""
    return sorted(name for time, name in events if time == events[at][0])


def parting(left, right, tolerance):
    """Where two recordings part, and what each has there; None if they do not."""
    for at in range(max(len(left), len(right))):
        one = left[at] if at < len(left) else None
        other = right[at] if at < len(right) else None
        if one is None or other is None or abs(one[0] - other[0]) > tolerance:
            return at, one, other
        if one[1] != other[1] and simultaneous(left, at) != simultaneous(right, at):
            return at, one, other
    return None


def told(folders, name, tolerance):
    """Lines that say where the recordings of a test part."""
    left, right = (events_of(folder, name) for folder in folders)
    found = parting(left, right, tolerance)
    if found is None:
        return ["  the recordings have the same events"]
    at, one, other = found
    lines = ["  the recordings part at event %d: %s | %s" % (at + 1, shown(one), shown(other))]
    if at:
        lines.append("  after %s | %s" % (shown(left[at - 1]), shown(right[at - 1])))
    return lines


def main():
    parser = argparse.ArgumentParser(description="Compares the results of two systems that were run on the same tests.")
    parser.add_argument("left", help="the folder of one run's results")
    parser.add_argument("right", help="that of the other's")
    parser.add_argument("--tolerance", type=float, default=0.5, metavar="SECONDS", help="of events' times (default: 0.5)")
    parser.add_argument("--all", action="store_true", help="also tests with the same verdicts whose recordings part")
    options = parser.parse_args()
    folders = (options.left, options.right)
    left, right = (tests_of(folder) for folder in folders)
    names = [name for name in left if name in right]
    only = len(left) + len(right) - 2 * len(names)
    different = parted = 0
    latest = 0.0
    for name in names:
        one, other = verdicts(left[name]), verdicts(right[name])
        lines = told(folders, name, options.tolerance)
        has_parted = len(lines) > 1 or "part at" in lines[0]
        parted += has_parted
        if not has_parted:
            pairs = zip(events_of(options.left, name), events_of(options.right, name))
            latest = max([latest] + [abs(a[0] - b[0]) for a, b in pairs])
        if one != other:
            different += 1
            keys = [key for key in sorted({**one, **other}) if one.get(key) != other.get(key)]
            print("%s: %s" % (name, ", ".join("%s %s | %s" % (k, one.get(k, "-"), other.get(k, "-")) for k in keys)))
            print("\n".join(lines))
        elif options.all and has_parted:
            print("%s: the same verdicts" % name)
            print("\n".join(lines))
    print("%d tests: the verdicts of %d differ, the recordings of %d part" % (len(names), different, parted))
    print("in the others, events differ by %.3f s at most" % latest)
    if only:
        print("%d tests are in one of the runs only" % only)
    return 1 if different or only else 0


if __name__ == "__main__":
    sys.exit(main())
