"""What it costs to stream set-points: nine publications of a Float64 every 10 ms, for 300 s of simulated time.

    python3 sdk/python/benches/streaming.py

The harness answers each wait at once and reads past all else; it is a process of its own, whose time does not count. Told are the
processor seconds of the program, and what of them is its start and end.
"""

import os
import resource
import subprocess
import sys
import tempfile

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


def cost(program: str, steps: int, env: "dict[str, str]") -> float:
    from harness import RUNNER

    read, its_write = os.pipe()
    its_read, write = os.pipe()
    harness = subprocess.Popen([sys.executable, "-S", "-c", HARNESS, str(read), str(write)], pass_fds=(read, write))
    env = {**os.environ, **env, "HRDSL_SEED": "1", "HRDSL_REQUEST_FD": str(its_write), "HRDSL_REPLY_FD": str(its_read)}
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, "-S", RUNNER, program, str(steps)], pass_fds=(its_write, its_read), env=env, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    for end in (read, write, its_read, its_write):
        os.close(end)
    harness.wait()
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def main() -> None:
    sys.path.insert(0, TESTS)
    from tables import bound

    with tempfile.TemporaryDirectory() as folder:
        program = os.path.join(folder, "arm.py")
        with open(program, "w") as file:
            file.write(PROGRAM)
        env = bound(folder, ["std_msgs"])
        whole, start = (min(cost(program, steps, env) for _ in range(3)) for steps in (30000, 0))
    print("%.2f s of processor time, of which %.3f s are the start and the end" % (whole, start))


if __name__ == "__main__":
    main()
