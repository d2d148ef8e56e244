#!/usr/bin/python3
"""Runs the programs of this folder with ROS 1 and keeps what they print; those that are named, or all. README.md says more."""

import difflib
import os
import queue
import signal
import socket
import subprocess
import sys
import threading
import time

FOLDER = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(FOLDER))

from rospy_text import Head, kept  # noqa: E402


class Master:
    """A `roscore` of our own, for one program after the other."""

    def __init__(self, port):
        self.environment = {**os.environ, "ROS_MASTER_URI": "http://127.0.0.1:%d" % port, "ROS_IP": "127.0.0.1", "TZ": "UTC",
                            "PYTHONDONTWRITEBYTECODE": "1", "PYTHONIOENCODING": "utf-8"}  # fmt: skip
        command = ["roscore", "-p", str(port)]
        self._process = subprocess.Popen(command, env=self.environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self._wait(port)

    def _wait(self, port):
        for _ in range(100):
            with socket.socket() as asked:
                if asked.connect_ex(("127.0.0.1", port)) == 0:
                    break
            time.sleep(0.3)
        time.sleep(4)  # for the node that keeps the log

    def run(self, name):
        """What the program prints on standard output and, if it is to be compared, on standard error."""
        path = os.path.join(FOLDER, name + ".py")
        with open(path) as file:
            head = Head(file.read())
        done = subprocess.run(["/usr/bin/python3", path, *head.arguments], env={**self.environment, **head.environment}, timeout=100,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8")  # fmt: skip
        err = kept(done.stderr, FOLDER)
        if err and not head.has_stderr:
            print("%s also says:\n%s" % (name, err))
        if done.returncode != head.code:
            print("%s: code %d" % (name, done.returncode))
        return kept(done.stdout, FOLDER), err if head.has_stderr else ""

    def end(self):
        self._process.send_signal(signal.SIGINT)
        self._process.wait()


def record(master, name, turns):
    """Keeps what the program prints, if it prints it each time."""
    try:
        found = [master.run(name) for _ in range(turns)]
    except subprocess.TimeoutExpired:
        return "%s: does not end" % name
    for other in found:
        if other != found[0]:
            lines = difflib.unified_diff(*("".join(texts).splitlines() for texts in (found[0], other)), lineterm="", n=0)
            return "%s: differs from run to run\n%s" % (name, "\n".join(list(lines)[2:]))
    for end, text in zip((".out", ".err"), found[0]):
        path = os.path.join(FOLDER, name + end)
        if text:
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)
        elif os.path.exists(path):
            os.remove(path)
    return "%s: %d lines" % (name, sum(len(text.splitlines()) for text in found[0]))


def work(port, names, turns):
    master = Master(port)
    try:
        while True:
            print(record(master, names.get_nowait(), turns), flush=True)
    except queue.Empty:
        pass
    finally:
        master.end()


def main():
    turns, workers = int(os.environ.get("TURNS", "5")), int(os.environ.get("WORKERS", "1"))
    every = sorted(name[:-3] for name in os.listdir(FOLDER) if name.endswith(".py") and name != "record.py")
    names = queue.Queue()
    for name in sys.argv[1:] or every:
        names.put(name)
    threads = [threading.Thread(target=work, args=(11411 + number, names, turns)) for number in range(workers)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()


if __name__ == "__main__":
    main()
