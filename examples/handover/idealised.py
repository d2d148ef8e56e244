"""Compares the tests' verdicts with those in the idealised world that the hand-over once had.

    python3 idealised.py tests FOLDER TO      FOLDER's tests, as files that the build of that world runs, into TO
    python3 idealised.py table IDEAL NOW      the table of idealised.md, from the output folders of both builds

The second form reads the contacts in recordings: pip install mcap zstandard
"""

import collections
import json
import pathlib
import re
import sys

# The ranges from which these two are drawn begin elsewhere now: the axes of a gaze turned round, and the hand takes a leg lower.
OFFSET = {"true": 0.3, "false": 0.7}
HIGHER = -0.05

# So long before a failure of R6, s, a contact may have been its cause; the steps of recordings are 0.01 s.
BEFORE = 0.2
AFTER = 0.011
# What presses less has no part in it, N.
LEAST = 0.3

SENSORS = (
    "The sensors read otherwise, or nobody asks them: with a whole body the person does not stand, look or hold where a head"
    " and a hand alone were, or the leg is lost before."
)
CAUSES = {
    ("R1", "pass", "vacuous"): SENSORS,
    ("R1", "vacuous", "pass"): SENSORS,
    ("R3", "pass", "vacuous"): SENSORS,
    ("R3", "vacuous", "pass"): SENSORS,
    ("R4", "pass", "inconclusive"): "The leg is lost before the decision, to somebody who draws it or to what it meets, and"
    " nothing is in the hand to be let go of. A hand that is glued to the leg, as there was, cannot lose it.",
    ("R5", "fail", "pass"): "The person takes the leg 12 cm below its middle instead of 5 cm, since a hand that others can"
    " touch cannot be where the robot's fingers will be: in about half of them it is up to 10 mm farther from these than the limit, where"
    " it was up to 44 mm nearer. In the others it is far from them, since an arm reaches only so far from where the person stands.",
    ("R5", "fail", "vacuous"): "The fingers are not closed at all: the course of the test is another one.",
    ("R5", "pass", "fail"): "The person, who has a body and reaches as far as an arm does, still has the hand at the stand.",
    "carried": "The leg in the hand, and in some a finger besides, meets the person's upper arm or head, or is drawn along it as"
    " it is let go of.",
    "arm": "The arm meets the person, or the person the arm: upper arm, forearm, hand, head, trunk or thigh.",
    "drawn": "The leg that the person draws out of the opening hand, or still holds as it closes, strikes a finger or the palm.",
    "legs": "The leg in the hand, or a finger, meets a leg beside it.",
}


def translate(test):
    """A test's text with the numbers that mean the same in the idealised world."""

    def offset(found):
        return f"{found[1]}{float(found[3]) + OFFSET[found[2]]:.6f}"

    test = re.sub(r"(look\((true|false)\) with offset = )(-?[\d.e-]+)", offset, test)
    return re.sub(r"(reach\(true\) with .*dz = )-0\.12 m", rf"\g<1>{HIGHER} m", test)


def verdicts(folder):
    """By test, what each requirement came to."""
    found = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    return {
        test["name"].split(".", 1)[1]: {verdict["requirement"]: verdict for verdict in test["verdicts"]}
        for test in found["tests"]
    }


def contacts(recording, until):
    """The greatest force of each pair that touched in the time before, N."""
    from mcap.reader import NonSeekingReader

    forces = collections.defaultdict(float)
    with recording.open("rb") as file:
        for _, channel, message in NonSeekingReader(file).iter_messages():
            if channel.topic != "/hrdsl/tracks":
                continue
            tracks = json.loads(message.data)
            for contact in tracks.get("contacts", []):
                time, force = 0, [0, 0, 0]
                for step, later in enumerate(contact["t"]):
                    time += later
                    force = [is_ + axis[step] for is_, axis in zip(force, contact["f"])]
                    size = sum((part / 100) ** 2 for part in force) ** 0.5
                    if -BEFORE <= time * tracks["tick"] * 1e-9 - until <= AFTER:
                        pair = tuple(contact["bodies"])
                        forces[pair] = max(forces[pair], size)
    return {pair: force for pair, force in forces.items() if force > LEAST}


def blow(forces):
    """What made the arm fast: the hardest contact that is not the hand's grip of a leg; or else that."""

    def kinds(pair):
        return {body.rstrip("1234").split(".")[0] for body in pair}

    causes = {"arm": {"robot", "person"}, "carried": {"leg", "person"}, "legs": {"leg"}}
    hardest = {
        cause: max((force for pair, force in forces.items() if kinds(pair) == those), default=0)
        for cause, those in causes.items()
    }
    cause = max(hardest, key=hardest.get)
    return cause if hardest[cause] > 0 else "drawn"


def table(ideal, now):
    """The rows: a kind of change, its cause, and the tests."""
    was, is_ = verdicts(ideal), verdicts(now)
    rows, forces = collections.defaultdict(list), collections.defaultdict(float)
    for test in sorted(was):
        for name, verdict in was[test].items():
            change = (name, verdict["outcome"], is_[test][name]["outcome"])
            if change[1] == change[2]:
                continue
            if name == "R6":
                found = contacts(now / "replays" / f"handover.{test}.mcap", is_[test][name]["failure"]["time"])
                change += (blow(found),)
                forces[change] = max(forces[change], *found.values())
            rows[change].append(test)
    changed = {test for tests in rows.values() for test in tests}
    print(f"{sum(map(len, rows.values()))} verdicts of {6 * len(was)}, in {len(changed)} tests\n")
    print("| verdict | tests | cause | which |\n|---|---|---|---|")
    for change, tests in sorted(rows.items()):
        cause = CAUSES[change[-1] if change in forces else change]
        if change in forces:
            cause += f" With up to {forces[change]:.0f} N."
        suites = collections.defaultdict(list)
        for test in tests:
            suite, number = test.split(".")
            suites[suite].append(number)
        which = "; ".join(f"{suite} {', '.join(numbers)}" for suite, numbers in suites.items())
        print(f"| {change[0]} {change[1]} → {change[2]} | {len(tests)} | {cause} | {which} |")


def main():
    match sys.argv[1:]:
        case ["tests", folder, to]:
            pathlib.Path(to).mkdir(parents=True, exist_ok=True)
            for file in sorted(pathlib.Path(folder).glob("*.hri")):
                text = translate(file.read_text(encoding="utf-8"))
                (pathlib.Path(to) / file.name).write_text(text, encoding="utf-8")
        case ["table", ideal, now]:
            table(pathlib.Path(ideal), pathlib.Path(now))
        case _:
            sys.exit(__doc__.strip())


main()
