"""Programs with threads: as in CPython, but in simulated time and always in the same order."""

import subprocess
import sys
import textwrap
import unittest

from harness import run_plain, run_text
from system import System

#: Programs may say what happens when, and in which thread.
SAY = """
import threading, time
def say(*what):
    print("%.3f" % time.monotonic(), threading.current_thread().name, *what)
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
                    lambda: setattr(lock, "other", 1), lambda: weakref.ref(lock)() is lock,
                    lambda: type(lock).__name__, lambda: type(lock).__module__,
                ):
                    print(what(call))
                class Holder:
                    held = lock
                assert Holder().held is lock and bool(lock)
            lock = threading.Lock()
            print(lock.locked(), lock.acquire(), lock.locked(), lock.acquire(False), lock.acquire(timeout=0), lock.locked())
            print(what(lambda: type("Mine", (type(lock),), {})).replace("_thread.", ""))
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

    def test_workers_of_an_executor_end_with_the_test_in_silence(self):
        text = """
            import concurrent.futures
            pool = concurrent.futures.ThreadPoolExecutor(2)
            say(pool.submit(lambda: 7).result())
            failed = pool.submit(lambda: 1 / 0)
            say(repr(failed.exception()))
            pool.submit(time.sleep, 100)
            time.sleep(10)
            """
        self.assertEqual(
            self.said(text, system=System(end=10**9)),
            ["0.000 MainThread 7", "0.000 MainThread ZeroDivisionError('division by zero')"],
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

    def test_clocks_of_all_kinds_are_polls(self):
        text = """
            import asyncio, datetime, os, resource
            loop = asyncio.new_event_loop()
            for clock in (
                lambda: datetime.datetime.now().timestamp() - 1735689600, lambda: datetime.datetime.utcnow().timestamp() - 1735689600,
                lambda: os.times().elapsed, lambda: os.times().user, lambda: resource.getrusage(resource.RUSAGE_SELF).ru_utime,
                lambda: time.gmtime().tm_sec / 100, lambda: time.clock_gettime(time.CLOCK_MONOTONIC), lambda: time.process_time(),
                loop.time,
            ):
                start = clock()
                while clock() < start + 0.01:
                    pass
                print("end")
            """
        # `utcnow` is deprecated from Python 3.12 on.
        finished = run_text("import warnings\nwarnings.simplefilter('ignore')\n" + SAY + textwrap.dedent(text))
        self.assertEqual((finished.code, finished.err, finished.out), (0, "", "end\n" * 9))

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


if __name__ == "__main__":
    unittest.main()
