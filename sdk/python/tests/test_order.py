"""Programs with threads: their order, their faults, and the processes that they start."""

import json
import os
import subprocess
import sys
import tempfile
import textwrap
import unittest

from harness import Program, run_text

#: Programs may say what happens when, and in which thread.
SAY = """
import threading, time
def say(*what):
    print("%.3f" % time.monotonic(), threading.current_thread().name, *what)
"""

STRESS = SAY + """
import concurrent.futures, queue, random
lock, rlock, condition = threading.Lock(), threading.RLock(), threading.Condition()
barrier, semaphore, items = threading.Barrier(5), threading.BoundedSemaphore(3), queue.PriorityQueue(4)
simple, event, chance = queue.SimpleQueue(), threading.Event(), random.Random(1)
def work(number):
    chances = random.Random(number)
    for turn in range(4):
        with lock:
            time.sleep(chances.random() / 100)
        with rlock, rlock:
            say("locked", turn)
        with semaphore:
            time.sleep(chances.choice([0, 0.01, 0.02]))
        if number < 10:
            say("barrier", barrier.wait())
        elif number < 20:
            items.put((chances.random(), number))
            with condition:
                condition.notify(2)
        else:
            try:
                say("got", items.get(timeout=0.05)[1])
            except queue.Empty:
                say("nothing")
            with condition:
                say("notified", condition.wait(0.03))
        simple.put(number)
threads = [threading.Thread(target=work, args=(number,), name="t%d" % number) for number in range(30)]
timers = [threading.Timer(n / 7, say, ["timer", n]) for n in range(5)]
for thread in timers + threads:
    thread.start()
with concurrent.futures.ThreadPoolExecutor(4) as pool:
    for future in concurrent.futures.as_completed([pool.submit(time.sleep, n % 5 / 9) for n in range(12)]):
        say("done")
while any(thread.is_alive() for thread in threads):
    try:
        say("at", simple.get(timeout=0.2), items.qsize())
        items.get_nowait()
    except queue.Empty:
        say("empty")
for thread in timers + threads:
    thread.join()
say("end")
"""


class Case(unittest.TestCase):
    maxDiff = None

    def said(self, text, **how):
        finished = run_text(SAY + textwrap.dedent(text), **how)
        self.assertEqual((finished.code, finished.err), (0, ""))
        return finished.out.splitlines()


class Faults(Case):
    def test_a_deadlock_is_told(self):
        text = """
            import threading, time, queue
            one, two, items = threading.Lock(), threading.RLock(), queue.Queue()
            def first():
                with one:
                    time.sleep(1)
                    with two:
                        pass
            def second():
                with two:
                    time.sleep(1)
                    one.acquire()
            threads = [threading.Thread(target=f, name=f.__name__) for f in (first, second, items.get)]
            for thread in threads:
                thread.start()
            try:
                threads[0].join()
            except Exception:
                print("never")
            finally:
                print("finally")
            """
        finished = run_text(text)
        self.assertEqual((finished.code, finished.out), (1, "finally\n"))
        lines = finished.err.splitlines()
        self.assertEqual(len(lines), 5, finished.err)
        self.assertIn("deadlock", lines[0])
        self.assertRegex(lines[1], r"thread MainThread waits in Thread.join at .*/program.py:17 for thread first$")
        self.assertRegex(lines[2], r"thread first waits in RLock at .*/program.py:7, held by thread second$")
        self.assertRegex(lines[3], r"thread second waits in Lock at .*/program.py:12, held by thread first$")
        self.assertRegex(lines[4], r"thread get waits in Queue.get$")

    def test_so_are_those_of_one_thread_and_of_the_end(self):
        finished = run_text("import threading\nlock = threading.Lock()\nlock.acquire()\nwith lock:\n    pass")
        self.assertEqual(finished.code, 1)
        self.assertRegex(finished.err, r"MainThread waits in Lock at .*program.py:4, held by itself\n$")
        finished = run_text("import threading\nthreading.Thread(target=threading.Event().wait, name='t').start()")
        self.assertEqual(finished.code, 1)
        self.assertIn("thread MainThread waits in the end of the program for its other threads\n", finished.err)
        self.assertIn("thread t waits in Event.wait\n", finished.err)
        self.assertNotIn({"request": "done"}, finished.requests)
        finished = run_text("import threading\ntry:\n    threading.Event().wait()\nexcept BaseException:\n    pass")
        self.assertEqual(finished.code, 1, "caught or not")

    def test_a_loop_that_never_waits_is_told(self):
        text = """
            import threading, time
            class Node:
                message = None
            def receive():
                time.sleep(1)
                Node.message = 1
            def wait():
                while Node.message is None:
                    pass
            threading.Thread(target=receive).start()
            """
        for here in "wait()", "t = threading.Thread(target=wait); t.start(); t.join()":
            with self.subTest(here=here):
                finished = run_text(textwrap.dedent(text) + "%s\nprint('after')" % here, env={"HRDSL_BUSY_SECONDS": "0.2"})
                self.assertEqual((finished.code, finished.out), (1, ""))
                self.assertRegex(finished.err, r"^hrdsl: .*/program.py:(9|10): .*Event.wait\(timeout\) or a queue")
                self.assertEqual(len(finished.err.splitlines()), 1, finished.err)

    def test_to_compute_for_long_is_no_fault(self):
        text = """
            import ctypes, threading, time
            class Time(ctypes.Structure):
                _fields_ = [("seconds", ctypes.c_long), ("nanos", ctypes.c_long)]
            def used():
                now = Time()
                ctypes.CDLL(None).clock_gettime(2, ctypes.byref(now))
                return now.seconds + now.nanos / 1e9
            threading.Thread(target=int).start()
            while used() < 0.6:
                pass
            threading.Timer(1, print, ["timer"]).start()
            """
        finished = run_text(text, env={"HRDSL_BUSY_SECONDS": "0.1"})
        self.assertEqual((finished.code, finished.out), (0, "timer\n"))
        self.assertRegex(finished.err, r"^hrdsl: .*/program.py:\d+: thread MainThread has computed for more than 0.1 s of processor time without")
        self.assertEqual(len(finished.err.splitlines()), 1, "it is told once")

    def test_a_program_that_computes_little_is_never_looked_at(self):
        # A look leaves other objects at other addresses, and must not depend on how long the machine takes.
        text = """
            import threading
            from hrdsl import watch
            looks = []
            real = watch._processor_time
            watch._processor_time = lambda task: looks.append(task) or real(task)
            threading.Thread(target=int).start()
            watch.real_sleep(0.5)
            print(len(looks))
            place = 0
            while not looks and place < 10**8:
                place += 1
            print(len(looks) > 0)
            """
        finished = run_text(text, env={"HRDSL_BUSY_SECONDS": "0.8"})
        self.assertEqual((finished.code, finished.out), (0, "0\nTrue\n"), finished.err)

    def test_a_thread_alone_is_told_where_it_computes_and_how_it_would_wait(self):
        for begin, how in (
            ("import hrdsl\nnode = hrdsl.Node('a')\nnode.emit('a')\n", "or with Node.wait_for or Node.sleep"),
            ("import asyncio\n", "with `await asyncio.sleep(seconds)`, or for an asyncio.Event"),
        ):
            text = begin + "async def look():\n    left = 3 * 10**7\n    while left:\n        left -= 1\n"
            text += "asyncio.run(look())" if "asyncio" in begin else "try:\n    look().send(None)\nexcept StopIteration:\n    print('end')"
            finished = run_text(text, env={"HRDSL_BUSY_SECONDS": "0.3"})
            lines = [place + 1 for place, line in enumerate(text.splitlines()) if "left" in line]
            self.assertEqual(finished.code, 0, "it is no fault")
            self.assertRegex(finished.err, r"^hrdsl: .*/program.py:(%s): thread MainThread has" % "|".join(map(str, lines)))
            self.assertTrue(finished.err.endswith(how + "\n"), finished.err)
            self.assertEqual(len(finished.err.splitlines()), 1, finished.err)

    def test_after_a_stop_all_threads_end(self):
        text = """
            import sys, threading, time
            import hrdsl
            node = hrdsl.Node("robot")
            def work():
                try:
                    threading.Event().wait()
                finally:
                    print("work ends")
            threading.Thread(target=work).start()
            node.emit("stop")
            """
        program = StoppedAt("emit", text)
        self.assertEqual((program.code, program.out, program.err), (0, "work ends\n", ""))
        program = StoppedAt("wait", text.replace('node.emit("stop")', "threading.Event().wait(1)"))
        self.assertEqual((program.code, program.out, program.err), (0, "work ends\n", ""))


def StoppedAt(kind, text):
    """What is left of a program that is stopped at its first request of this kind."""
    class Stopping(Program):
        def _answer(self):
            for line in self._lines:
                request = json.loads(line)
                self.requests.append(request)
                os.write(self.replies, b'{"t":0,"ok":true%s}\n' % (b',"stop":true' if request["request"] == kind else b""))

    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "program.py")
        with open(path, "w") as file:
            file.write(textwrap.dedent(text))
        return Stopping([path]).finish()


class Order(Case):
    def test_thirty_threads_do_the_same_each_time(self):
        cores = sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else []
        pin = [lambda: os.sched_setaffinity(0, {cores[0]})] if cores else []
        finished = [run_text(STRESS, preexec_fn=how) for how in (None, None, *pin)]
        load = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(2)]
        try:
            finished += [run_text(STRESS, preexec_fn=how) for how in (None, *pin)]
        finally:
            for process in load:
                process.kill()
                process.wait()
        self.assertEqual({(one.code, one.err) for one in finished}, {(0, "")})
        self.assertGreater(finished[0].out.count("\n"), 250)
        for other in finished[1:]:
            self.assertEqual(other.out, finished[0].out)
            self.assertEqual(other.requests, finished[0].requests)

    def test_schedules_by_a_seed_find_a_race(self):
        text = """
            account = 100
            def withdraw(amount):
                global account
                time.sleep(1)
                before = account
                gate.wait()
                account = before - amount
            gate = threading.Barrier(2)
            threads = [threading.Thread(target=withdraw, args=(amount,)) for amount in (10, 20)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            say(account)
            """
        found = {}
        for seed in (1, 2, 3, 4, 5, 6):
            runs = {tuple(self.said(text, env={"HRDSL_SCHEDULE": str(seed)})) for _ in range(2)}
            self.assertEqual(len(runs), 1, "the same seed, the same order")
            found.setdefault(runs.pop(), []).append(seed)
        self.assertEqual(set(found), {("1.000 MainThread 90",), ("1.000 MainThread 80",)}, found)
        self.assertEqual(len({tuple(self.said(text)) for _ in range(3)}), 1)

    def test_a_seed_is_a_number(self):
        finished = run_text("print(1)", env={"HRDSL_SCHEDULE": "abc"})
        self.assertEqual((finished.code, finished.out), (1, ""))
        self.assertIn("HRDSL_SCHEDULE is 'abc', which is no number", finished.err)


class Processes(Case):
    def test_what_is_forked_past_the_refusal_has_one_thread_and_locks_that_work(self):
        text = """
            import os, posix, queue, sys, warnings
            warnings.simplefilter("ignore")
            lock, go = threading.Lock(), threading.Event()
            def hold():
                with lock:
                    go.wait()
            def want():
                with lock:
                    pass
            threads = [threading.Thread(target=f) for f in (hold, want)]
            for thread in threads:
                thread.start()
            sys.stdout.flush()
            child = posix.fork()
            if not child:
                say(threading.active_count(), lock.locked(), threads[0].is_alive())
                lock.release()
                with lock:
                    items = queue.SimpleQueue()
                    thread = threading.Thread(target=items.put, args=(5,))
                    thread.start()
                    say(items.get(), thread.join())
                try:
                    go.wait(1)
                except RuntimeError as error:
                    say(type(error).__name__)
                sys.stdout.flush()
                os._exit(7)
            say(os.waitpid(child, 0)[1] >> 8, lock.locked())
            go.set()
            for thread in threads:
                thread.join()
            warnings.simplefilter("error")  # that there is more than one thread
            child = posix.fork()
            if not child:
                os._exit(0)
            say(os.waitpid(child, 0)[1])
            """
        main = "0.000 MainThread "
        self.assertEqual(
            self.said(text), [main + "1 True False", main + "5 None", main + "ProtocolError", main + "7 True", main + "0"]
        )

    def test_multiprocessing_is_refused_and_its_threads_are_not(self):
        text = """
            import multiprocessing, multiprocessing.pool
            for start in multiprocessing.Process(target=print).start, lambda: multiprocessing.Pool(2):
                try:
                    start()
                except RuntimeError as error:
                    print(type(error).__module__, type(error).__name__, str(error).split(";")[1])
            with multiprocessing.pool.ThreadPool(2) as pool:
                say(pool.map(lambda seconds: time.sleep(seconds), [1, 2, 2]))
            """
        refused = "hrdsl.errors Unsupported  use threads (threading, concurrent.futures.ThreadPoolExecutor), or subprocess.run for a child that is waited for"
        self.assertEqual(self.said(text), [refused] * 2 + ["3.000 MainThread [None, None, None]"])

    def test_processes_that_nobody_waits_for_are_refused(self):
        text = """
            import asyncio, os, pty
            for name, start in (
                ("os.fork", os.fork), ("os.forkpty", os.forkpty), ("os.forkpty", lambda: pty.spawn("true")),
                ("os.posix_spawn", lambda: os.posix_spawn("/bin/true", ["true"], {})),
                ("os.spawnlp", lambda: os.spawnlp(os.P_NOWAIT, "true", "true")),
                ("asyncio.create", lambda: asyncio.run(asyncio.create_subprocess_exec("true"))),
                ("asyncio.create", lambda: asyncio.run(asyncio.create_subprocess_shell("true"))),
            ):
                try:
                    start()
                except RuntimeError as error:
                    print(type(error).__name__, str(error).startswith(name), str(error).split(";")[1])
            """
        instead = " run a command to its end with subprocess.run, use threads, or make it a `program` of the system"
        self.assertEqual(self.said(text), ["Unsupported True " + instead] * 7)

    def test_a_wait_while_a_child_lives_ends_the_program(self):
        text = """
            import os, select, subprocess, threading, time
            def start():
                return subprocess.Popen(["sleep", "1"])
            def wait():
                start()
                %s
            try:
                wait()
            except Exception:
                print("never")
            finally:
                print("finally")
            """
        told = " simulated time is to pass, or another thread to run, while `sleep 1` lives, a process that runs in real time; "
        told += "run it to its end first (subprocess.run, communicate(), wait()), or make it a `program` of the system\n"
        waits = ("time.sleep(1)", "threading.Event().wait(1)", "threading.Thread(target=int).start()", "select.select([], [], [], 1)")
        looks = ("select.select([0], [], [], 0)", "[time.time() for _ in range(3001)]", "__import__('hrdsl').Node('x').sleep(1)")
        for wait in (*waits, *looks, "__import__('asyncio').run(__import__('asyncio').sleep(1))"):
            with self.subTest(wait=wait):
                finished = run_text(text % wait)
                self.assertEqual((finished.code, finished.out), (1, "finally\n"), finished.err)
                self.assertRegex(finished.err, r"^hrdsl: .*/program.py:7:")
                self.assertEqual(finished.err.partition("program.py:7:")[2], told)
                self.assertNotIn("wait", [request["request"] for request in finished.requests])

    def test_so_does_one_that_a_thread_leaves_behind(self):
        text = """
            import subprocess
            def work():
                time.sleep(1)
                subprocess.Popen(["sleep", "1"])
            threading.Thread(target=lambda: (time.sleep(9), print("never"))).start()
            threading.Thread(target=work).start()
            """
        finished = run_text(SAY + textwrap.dedent(text))
        self.assertEqual((finished.code, finished.out), (1, ""))
        self.assertRegex(finished.err, "^hrdsl: simulated time is to pass, .* while `sleep 1` lives, .*\n$")

    def test_native_libraries_compute_in_one_thread(self):
        text = "import os\nprint(os.environ['OMP_NUM_THREADS'], os.environ['OPENBLAS_NUM_THREADS'])"
        env = {"OMP_NUM_THREADS": "3"}
        self.assertEqual(run_text(text, env=env).out, "3 1\n")


if __name__ == "__main__":
    unittest.main()
