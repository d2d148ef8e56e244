"""Programs with threads: as in CPython, but in simulated time and always in the same order."""

import json
import os
import subprocess
import sys
import tempfile
import textwrap
import unittest

from harness import Program, run_plain, run_text

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

    def same(self, text):
        """The program prints what it prints without hrdsl."""
        finished = run_text(text)
        self.assertEqual((finished.code, finished.err), (0, ""))
        self.assertEqual(finished.out, run_plain(text))
        return finished.out


class Semantics(Case):
    """What CPython and the scheduler do alike."""

    def test_locks(self):
        out = self.same(
            """
            import _thread, copy, pickle, re, threading, weakref
            def what(call):
                try:
                    return re.sub("0x[0-9a-f]+|owner=[0-9]+", "...", repr(call()))
                except Exception as error:
                    return "%s: %s" % (type(error).__name__, str(error).replace("'_thread.", "'"))
            for make in threading.Lock, threading.RLock, _thread.allocate_lock, _thread.RLock:
                lock = make()
                for call in (
                    lambda: lock, lambda: lock.release(), lambda: lock.acquire(False, 1), lambda: lock.acquire(True, -2),
                    lambda: lock.acquire(timeout=1e20), lambda: lock.acquire(timeout="a"), lambda: lock.acquire(True, None),
                    lambda: lock.acquire(), lambda: lock, lambda: lock.release(), lambda: lock.acquire(False), lambda: lock.release(),
                    lambda: lock.acquire(True, 0), lambda: lock.release(), lambda: lock.acquire(blocking=True, timeout=1),
                    lambda: lock.release(), lambda: lock.release(), lambda: pickle.dumps(lock), lambda: copy.copy(lock),
                    lambda: lock.__enter__(), lambda: lock.__exit__(None, None, None), lambda: lock.other,
                    lambda: setattr(lock, "other", 1), lambda: weakref.ref(lock)() is lock, lambda: lock._at_fork_reinit(),
                    lambda: type(lock).__name__, lambda: type(lock).__module__,
                ):
                    print(what(call))
                class Holder:
                    held = lock
                assert Holder().held is lock and bool(lock)
            lock = threading.Lock()
            print(lock.locked(), lock.acquire(), lock.locked(), lock.acquire(False), lock.acquire(timeout=0), lock.locked())
            print(what(lambda: type("Mine", (type(lock),), {})))
            """
        )
        self.assertIn("RuntimeError: release unlocked lock", out)
        self.assertIn("TypeError: cannot pickle 'RLock' object", out)

    def test_locks_of_one_owner(self):
        self.same(
            """
            import threading
            lock = threading.RLock()
            print(lock._is_owned(), lock.acquire(), lock.acquire(), lock._is_owned(), "count=2" in repr(lock))
            if hasattr(lock, "_recursion_count"):
                assert lock._recursion_count() == 2
            state = lock._release_save()
            print(state[0], lock._is_owned())
            lock._acquire_restore(state)
            def other():
                print(lock.acquire(False), lock._is_owned(), lock.acquire(timeout=0.01))
                try:
                    lock.release()
                except RuntimeError as error:
                    print(error)
            thread = threading.Thread(target=other)
            thread.start()
            thread.join()
            lock.release()
            lock.release()
            class Mine(type(lock)):
                pass
            with Mine() as got, Mine(1, two=2):
                print(got)
            """
        )

    def test_the_rest_of_threading(self):
        self.same(
            """
            import _thread, pickle, queue, sys, threading
            print(threading.current_thread() is threading.main_thread(), threading.active_count(), _thread._count())
            local = threading.local()
            local.x = 1
            def work(*args, **kwargs):
                print(args, kwargs, hasattr(local, "x"), threading.current_thread().name, _thread._count())
            thread = threading.Thread(target=work, args=(1,), kwargs={"a": 2}, name="worker", daemon=True)
            print(thread.is_alive(), thread.ident, thread.daemon)
            thread.start()
            thread.join()
            print(thread.is_alive(), thread.ident is None, repr(thread).split()[0])
            for wrong in thread.start, threading.current_thread().join, lambda: _thread.start_new_thread(1, ()), lambda: threading.Thread().join():
                try:
                    wrong()
                except (RuntimeError, TypeError) as error:
                    print(error)
            caught = []
            threading.excepthook = lambda args: caught.append((args.exc_type, args.thread.name))
            for target in lambda: 1 / 0, sys.exit:
                thread = threading.Thread(target=target, name="failing")
                thread.start()
                thread.join()
            print(caught)
            semaphore = threading.BoundedSemaphore(2)
            print(semaphore.acquire(), semaphore.acquire(blocking=False), semaphore.acquire(blocking=False))
            semaphore.release(2) if sys.version_info >= (3, 9) else [semaphore.release() for _ in range(2)]
            try:
                semaphore.release()
            except ValueError as error:
                print(error)
            condition = threading.Condition()
            for wrong in condition.wait, condition.notify:
                try:
                    wrong()
                except RuntimeError as error:
                    print(error)
            simple = queue.SimpleQueue()
            for item in "abc":
                simple.put(item)
            print(simple.qsize(), simple.get(), simple.get_nowait(), simple.get(timeout=5), simple.empty())
            for wrong in simple.get_nowait, lambda: simple.get(timeout=-1), lambda: simple.get(False), lambda: pickle.dumps(simple):
                try:
                    wrong()
                except (queue.Empty, ValueError, TypeError) as error:
                    print(type(error).__name__, error)
            barrier = threading.Barrier(1, action=lambda: print("passed"))
            print(barrier.wait(), barrier.n_waiting, barrier.broken)
            """
        )

    def test_an_exception_is_reported_as_by_the_interpreter(self):
        text = "import _thread, time, threading\n%s\ntime.sleep(0.3)"
        for start in "_thread.start_new_thread(f, ())", "threading.Thread(target=f).start()":
            program = text % ("def f():\n    1 / 0\n" + start)
            errors = run_text(program).err.splitlines()
            plain = subprocess.run([sys.executable, "-c", program], stderr=subprocess.PIPE, universal_newlines=True)
            self.assertEqual(errors[0].split(" at ")[0], plain.stderr.splitlines()[0].split(" at ")[0])
            self.assertEqual(errors[-1], "ZeroDivisionError: division by zero")

    def test_threads_end_before_the_next_line(self):
        # What belongs to a thread is torn down by the system after its last line in Python.
        text = """
            import threading
            local = threading.local()
            class Last:
                def __del__(self):
                    print("gone")
            def work():
                local.last = Last()
            for _ in range(20):
                thread = threading.Thread(target=work)
                thread.start()
                thread.join()
                print("joined")
            """
        self.assertEqual(run_text(text).out, "gone\njoined\n" * 20)


class Time(Case):
    def test_every_timeout_is_simulated(self):
        text = """
            import asyncio, concurrent.futures, queue
            lock, event, condition = threading.Lock(), threading.Event(), threading.Condition()
            lock.acquire()
            say(lock.acquire(timeout=1.5))
            say(event.wait(1))
            with condition:
                say(condition.wait(0.25), condition.wait_for(lambda: False, 2))
            say(threading.Semaphore(0).acquire(timeout=3))
            for empty in queue.Queue(), queue.SimpleQueue(), queue.LifoQueue():
                try:
                    empty.get(timeout=0.5)
                except queue.Empty:
                    say("empty")
            try:
                threading.Barrier(2).wait(1)
            except threading.BrokenBarrierError:
                say("broken")
            threading.Timer(2, say, ["timer"]).start()
            sleeper = threading.Thread(target=time.sleep, args=(5,))
            sleeper.start()
            sleeper.join(3)
            say(sleeper.is_alive())
            sleeper.join()
            say(sleeper.is_alive())
            with concurrent.futures.ThreadPoolExecutor(2) as pool:
                futures = [pool.submit(time.sleep, seconds) for seconds in (1, 3)]
                say(len(concurrent.futures.wait(futures, timeout=2).done))
                try:
                    futures[1].result(timeout=0.5)
                except concurrent.futures.TimeoutError:
                    say("timeout")
            say("end")
            """
        said = self.said(text)
        expected = (
            "1.500 False,2.500 False,4.750 False False,7.750 False,8.250 empty,8.750 empty,9.250 empty,10.250 broken,"
            "12.250 timer,13.250 True,15.250 False,17.250 1,17.750 timeout,18.250 end"
        )
        self.assertEqual([" ".join(one for one in line.split() if "Th" not in one) for line in said], expected.split(","))

    def test_a_wait_ends_when_somebody_ends_it(self):
        text = """
            import queue
            event, items, condition, done = threading.Event(), queue.Queue(1), threading.Condition(), []
            def work():
                time.sleep(1)
                event.set()
                time.sleep(1)
                items.put(1)
                items.put(2)
                say("put")
                with condition:
                    done.append(1)
                    condition.notify_all()
            threading.Thread(target=work, name="work").start()
            say(event.wait(), event.wait(5))
            time.sleep(2)
            say(items.get(timeout=9), items.get(timeout=9))
            with condition:
                say(condition.wait_for(lambda: done, 9))
            """
        self.assertEqual(
            self.said(text), ["1.000 MainThread True True", "3.000 work put", "3.000 MainThread 1 2", "3.000 MainThread [1]"]
        )

    def test_a_node_s_sleep_lets_others_run(self):
        text = """
            import hrdsl
            node = hrdsl.Node("robot")
            threading.Timer(1, say, ["timer"]).start()
            node.sleep(2)
            say(node.now())
            """
        self.assertEqual(self.said(text), ["1.000 Thread-1 timer", "2.000 MainThread 2.0"])

    def test_the_end_waits_for_threads_but_for_daemons(self):
        text = """
            import atexit, concurrent.futures
            atexit.register(say, "atexit")
            def work(name, seconds):
                time.sleep(seconds)
                say(name)
                time.sleep(seconds)
                say(name)
            threading.Thread(target=work, args=("thread", 2), name="t").start()
            threading.Thread(target=work, args=("daemon", 3), name="d", daemon=True).start()
            pool = concurrent.futures.ThreadPoolExecutor()
            pool.submit(time.sleep, 1)
            say("end")
            """
        text = SAY + textwrap.dedent(text)
        finished = run_text(text)
        expected = ["0.000 MainThread end", "2.000 t thread", "3.000 d daemon", "4.000 t thread", "4.000 MainThread atexit"]
        self.assertEqual(finished.out.splitlines(), expected)
        self.assertEqual(finished.requests[-1], {"request": "done"})
        finished = run_text(text + "import sys\nsys.exit(3)")
        self.assertEqual((finished.out.splitlines(), finished.code), (expected, 3))


class Polling(Case):
    def test_loops_that_poll_let_time_pass(self):
        for poll in (
            "time.time() < 1735689600.01", "not event.is_set()", "simple.empty()", "items.empty()", "got()", "not free()",
            "lock.locked()", "thread.is_alive()", "event.wait(0) is False", "time.sleep(0) or not event.is_set()",
        ):  # fmt: skip
            with self.subTest(poll=poll):
                text = """
                    import queue
                    event, lock, items, simple = threading.Event(), threading.Lock(), queue.Queue(), queue.SimpleQueue()
                    lock.acquire()
                    def work():
                        time.sleep(0.01)
                        event.set(), lock.release(), items.put(1), simple.put(1)
                    def got():
                        try:
                            items.get_nowait()
                        except queue.Empty:
                            return True
                    def free():
                        return lock.acquire(False)
                    thread = threading.Thread(target=work)
                    thread.start()
                    while %s:
                        pass
                    say("end")
                    """
                (line,) = self.said(text % poll)
                self.assertIn(line, ("0.010 MainThread end", "0.011 MainThread end"))

    def test_using_queues_and_locks_is_no_polling(self):
        text = """
            import queue
            items, event = queue.Queue(), threading.Event()
            for turn in range(5000):
                items.put(turn)
            for turn in range(5000):
                items.get()
                with threading.RLock():
                    pass
            say("end")
            """
        self.assertEqual(self.said(text), ["0.000 MainThread end"])


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
        self.assertIn("thread MainThread waits in the end of the program for thread t\n", finished.err)
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
        self.assertEqual((finished.code, finished.out, finished.err), (0, "timer\n", ""))

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
        program = StoppedAt("sleep", text.replace('node.emit("stop")', "threading.Event().wait(1)"))
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
    def test_a_forked_process_has_one_thread_and_locks_that_work(self):
        text = """
            import os, queue, sys, warnings
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
            child = os.fork()
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
            child = os.fork()
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
        refused = "hrdsl.errors Unsupported  use threads (threading, concurrent.futures.ThreadPoolExecutor), or subprocess for a child that is waited for"
        self.assertEqual(self.said(text), [refused] * 2 + ["3.000 MainThread [None, None, None]"])

    def test_native_libraries_compute_in_one_thread(self):
        text = "import os\nprint(os.environ['OMP_NUM_THREADS'], os.environ['OPENBLAS_NUM_THREADS'])"
        env = {"OMP_NUM_THREADS": "3"}
        self.assertEqual(run_text(text, env=env).out, "3 1\n")


if __name__ == "__main__":
    unittest.main()
