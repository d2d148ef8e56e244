"""Runs programs as `hrdsl sim` does, with a harness whose waits pass time and who says yes to all else."""

import json
import os
import subprocess
import sys
import tempfile
import textwrap
import threading

from system import System

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
RUNNER = os.path.join(ROOT, "hrdsl", "run.py")


class Finished:
    """What is left of a program that has ended."""

    def __init__(self, code, out, err, requests):
        self.code, self.out, self.err, self.requests = code, out, err, requests


class Program:
    """A program that runs, or has run."""

    def __init__(self, words, seed=17, options=(), keep=(), env=None, system=None, **popen):
        self.system = system or System()
        requests, its_requests = os.pipe()
        its_replies, self.replies = os.pipe()
        given = {key: value for key, value in os.environ.items() if not key.startswith("HRDSL_")}
        given.update(HRDSL_SEED=str(seed), PYTHONHASHSEED=str(seed), TZ="UTC", HRDSL_SYS_PATH=os.pathsep.join(sys.path))
        given.update(HRDSL_REQUEST_FD=str(its_requests), HRDSL_REPLY_FD=str(its_replies), **(env or {}))
        pipes = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **popen}
        self.process = subprocess.Popen(
            self.command(words, options), pass_fds=(its_requests, its_replies, *keep), env=given, universal_newlines=True, **pipes
        )
        os.close(its_requests)
        os.close(its_replies)
        self.requests, self._lines = [], os.fdopen(requests)
        self._thread = threading.Thread(target=self._answer)
        self._thread.start()

    def command(self, words, options):
        return [sys.executable, "-S", RUNNER, *options, *words]

    def _answer(self):
        for line in self._lines:
            self.requests.append(json.loads(line))
            reply = self.system.answer(line)
            if reply is not None:
                try:
                    os.write(self.replies, (json.dumps(reply) + "\n").encode())
                except BrokenPipeError:
                    pass

    def finish(self):
        out, err = self.process.communicate()
        self._thread.join()
        self._lines.close()
        os.close(self.replies)
        return Finished(self.process.returncode, out, err, self.requests)


def run(words, **how):
    return Program(words, **how).finish()


def run_text(text, **how):
    """Runs a program of this text."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "program.py")
        with open(path, "w") as file:
            file.write(textwrap.dedent(text))
        return run([path], **how)


def run_plain(text):
    """What such a program prints when it runs without hrdsl."""
    command = [sys.executable, "-c", textwrap.dedent(text)]
    return subprocess.run(command, stdout=subprocess.PIPE, universal_newlines=True, check=True).stdout
