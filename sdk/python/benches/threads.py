"""What threads in simulated time cost, beside those of the system.

    taskset -c 0 python3 sdk/python/benches/threads.py
    python3 sdk/python/benches/threads.py

Each line is the best of several rounds, in microseconds of processor time for one operation: as the interpreter does it, and as a
program under test does it, in a process of its own. The switches of the interpreter are those of two real locks.
"""

import json
import os
import subprocess
import sys
import tempfile

TESTS = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "tests")

PROGRAM = """
import asyncio, ctypes, json, logging, queue, threading

class Time(ctypes.Structure):
    _fields_ = [("seconds", ctypes.c_long), ("nanos", ctypes.c_long)]

libc, now = ctypes.CDLL(None), Time()

def real():
    libc.clock_gettime(2, ctypes.byref(now))  # CLOCK_PROCESS_CPUTIME_ID: what else the machine does counts little
    return now.seconds + now.nanos / 1e9

def best(measure, count, rounds=5):
    return min(timed(measure, count) for _ in range(rounds)) / count * 1e6

def timed(measure, count):
    start = real()
    measure(count)
    return real() - start

def switches(count):
    here, there = threading.Lock(), threading.Lock()
    here.acquire(), there.acquire()
    def other():
        for _ in range(count // 2):
            there.acquire()
            here.release()
    thread = threading.Thread(target=other)
    thread.start()
    for _ in range(count // 2):
        there.release()
        here.acquire()
    thread.join()

def lock(count):
    lock = threading.Lock()
    for _ in range(count):
        with lock:
            pass

def rlock(count):
    lock = threading.RLock()
    for _ in range(count):
        with lock:
            pass

def one_queue(count):
    items = queue.Queue()
    for i in range(count):
        items.put(i)
        items.get()

def simple_queue(count):
    items = queue.SimpleQueue()
    for i in range(count):
        items.put(i)
        items.get()

def log(count):
    logger = logging.getLogger("bench")
    for i in range(count):
        logger.warning("value %d", i)

def threads(count):
    for _ in range(count):
        thread = threading.Thread(target=int)
        thread.start()
        thread.join()

def loop_turns(count):
    async def main():
        loop, done = asyncio.get_running_loop(), asyncio.Event()
        left = count
        def turn():
            nonlocal left
            left -= 1
            if left:
                loop.call_soon(turn)
            else:
                done.set()
        loop.call_soon(turn)
        await done.wait()
    asyncio.run(main())

class Nowhere:
    def write(self, text):
        pass

logging.basicConfig(stream=Nowhere())
print(json.dumps({
    "a switch between two threads": best(switches, 20000),
    "with Lock()": best(lock, 100000),
    "with RLock()": best(rlock, 100000),
    "Queue.put and get": best(one_queue, 20000),
    "SimpleQueue.put and get": best(simple_queue, 50000),
    "a line of logging": best(log, 5000),
    "Thread start and join": best(threads, 1000),
    "a turn of asyncio": best(loop_turns, 30000),
}))
"""


def main() -> None:
    sys.path.insert(0, TESTS)
    from harness import run

    with tempfile.NamedTemporaryFile("w", suffix=".py") as file:
        file.write(PROGRAM)
        file.flush()
        plain = json.loads(subprocess.run([sys.executable, file.name], stdout=subprocess.PIPE, check=True).stdout)
        finished = run([file.name])
    if finished.code:
        sys.exit(finished.err)
    ours = json.loads(finished.out)
    print("%-32s %10s %10s" % ("", "plain, µs", "ours, µs"))
    for name, value in plain.items():
        print("%-32s %10.2f %10.2f" % (name, value, ours[name]))


if __name__ == "__main__":
    main()
