"""What it costs to stream set-points: nine publications of a Float64 every 10 ms, for 300 s of simulated time.

    python3 sdk/python/benches/streaming.py
    python3 sdk/python/benches/streaming.py --coverage [FOLDER]
    python3 sdk/python/benches/streaming.py --coverage [FOLDER] --lines

The harness answers each wait at once and reads past all else; it is a process of its own, whose time does not count. Told are the
processor seconds of the program, and what of them is its start and end: the least of several runs each. With coverage, the program's
lines and branches are recorded as in a test, by the coverage.py in the folder, or by that of the interpreter; with lines, also at which of
them it was when.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
from typing import IO

TESTS = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "tests")

PROGRAM = """
import sys
import rospy
from std_msgs.msg import Float64
joints = [rospy.Publisher("/joint_%d/command" % n, Float64, queue_size=1, latch=True) for n in range(9)]
rospy.init_node("arm")
rate = rospy.Rate(100)
for step in range(int(sys.argv[1])):
    for n, joint in enumerate(joints):
        joint.publish(0.1 * n + step * 1e-5)
    rate.sleep()
"""

HARNESS = """
import os, re, sys
requests, replies = os.fdopen(int(sys.argv[1]), "rb"), int(sys.argv[2])
time = 0
for line in requests:
    if line.startswith(b'{"request":"wait"'):
        time = int(re.search(rb"[0-9]+", line).group())
        os.write(replies, b'{"t":%d,"arrivals":[]}\\n' % time)
    elif not line.startswith(b'{"request":"publish"'):
        os.write(replies, b'{"t":%d,"version":2,"program":"arm"}\\n' % time)
"""


def cost(program: str, steps: int, env: "dict[str, str]", package: "str | None") -> float:
    from harness import RUNNER

    read, its_write = os.pipe()
    its_read, write = os.pipe()
    harness = subprocess.Popen([sys.executable, "-S", "-c", HARNESS, str(read), str(write)], pass_fds=(read, write))
    env = {**os.environ, **env, "HRDSL_SEED": "1", "HRDSL_REQUEST_FD": str(its_write), "HRDSL_REPLY_FD": str(its_read)}
    command, descriptors = [sys.executable, "-S", RUNNER], [its_write, its_read]
    with tempfile.TemporaryFile() as out:
        if package is not None:
            command += ["--coverage", program]
            descriptors.append(out.fileno())
            env.update(HRDSL_COVERAGE_FD=str(out.fileno()), HRDSL_COVERAGE_PACKAGE=package)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([*command, program, str(steps)], pass_fds=descriptors, env=env, check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        if package is not None:
            check(out, steps)
    for end in (read, write, its_read, its_write):
        os.close(end)
    harness.wait()
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def check(out: IO[bytes], steps: int) -> None:
    """What is measured is a run that was recorded."""
    out.seek(0)
    (found,) = json.loads(out.readline()).values()
    missed = set(found["statements"]) - set(found["executed"])
    if len(missed) != (0 if steps else 3):
        sys.exit("lines without a record: %s" % sorted(missed))


def package_of(given: "str | None") -> str:
    if given is not None:
        return given
    import coverage

    return os.path.dirname(os.path.dirname(coverage.__file__))


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--coverage", nargs="?", const="", metavar="FOLDER")
    parser.add_argument("--lines", action="store_true")
    arguments = parser.parse_args()
    given = arguments.coverage
    package = None if given is None else package_of(given or None)
    sys.path.insert(0, TESTS)
    from tables import bound

    with tempfile.TemporaryDirectory() as folder:
        program = os.path.join(folder, "arm.py")
        with open(program, "w") as file:
            file.write(PROGRAM)
        env = {**bound(folder, ["std_msgs"]), "HRDSL_COVERAGE_CACHE": folder, "HRDSL_LINES": "1" if arguments.lines else "0"}
        cost(program, 0, env, package)  # what follows from the program's text alone is found once
        whole, start = (min(cost(program, steps, env, package) for _ in range(5)) for steps in (30000, 0))
    print("%.2f s of processor time, of which %.3f s are the start and the end" % (whole, start))


if __name__ == "__main__":
    main()
