"""What `multiprocessing` shares between processes, used by the threads of one: in simulated time."""

import textwrap
import unittest

from harness import run_plain, run_text

SAY = """
import multiprocessing, queue, threading, time
def say(*what):
    print("%.3f" % time.monotonic(), *what)
def later(seconds, call, *args):
    threading.Timer(seconds, call, args).start()
"""


class Shared(unittest.TestCase):
    maxDiff = None

    def said(self, text):
        finished = run_text(SAY + textwrap.dedent(text))
        self.assertEqual((finished.code, finished.err), (0, ""))
        return finished.out.splitlines()

    def test_queues(self):
        text = """
            for kind in multiprocessing.Queue, multiprocessing.JoinableQueue:
                items = kind(2)
                items.put({"a": 1})
                say(items.get(), items.get() if items.qsize() else None)
                for call in lambda: items.get(timeout=1), lambda: [items.put(n, timeout=1) for n in range(3)]:
                    try:
                        call()
                    except (queue.Empty, queue.Full) as error:
                        say(type(error).__name__)
                say(items.get(), items.get(), items.empty(), items.qsize())
            later(1, items.put, "late")
            say(items.get())
            simple = multiprocessing.SimpleQueue()
            later(1, simple.put, "simple")
            say(simple.get(), simple.empty())
            """
        times = [float(line.split()[0]) for line in self.said(text)]
        said = [line.split(" ", 1)[1] for line in self.said(text)]
        self.assertEqual(said, ["{'a': 1} None", "Empty", "Full", "0 1 True 0"] * 2 + ["late", "simple True"])
        for time, expected in zip(times, (0, 1, 2, 2, 2, 3, 4, 4, 5, 6)):
            self.assertTrue(expected <= time < expected + 0.02, times)

    def test_more_than_a_pipe_holds(self):
        text = """
            items, (here, there) = multiprocessing.Queue(), multiprocessing.Pipe()
            big = bytes(range(256)) * 4000
            items.put(big)
            say(items.get() == big)
            later(1, here.send, big)
            say(there.recv() == big, there.poll(1))
            here.close()
            try:
                there.recv()
            except EOFError:
                say("closed")
            """
        said = self.said(text)
        self.assertEqual([line.split(" ", 1)[1] for line in said], ["True", "True False", "closed"])

    def test_tasks_of_a_queue(self):
        text = """
            items = multiprocessing.JoinableQueue()
            def work():
                for _ in range(3):
                    items.get()
                    time.sleep(1)
                    items.task_done()
            threading.Thread(target=work).start()
            for n in range(3):
                items.put(n)
            items.join()
            say("joined")
            """
        self.assertEqual(self.said(text), ["3.000 joined"])

    def test_waits_and_timeouts_are_simulated(self):
        text = """
            event = multiprocessing.Event()
            say(event.wait(2), event.is_set())
            later(1, event.set)
            say(event.wait(2), event.is_set())
            for make in multiprocessing.Lock, multiprocessing.Semaphore, multiprocessing.BoundedSemaphore:
                lock = make()
                with lock:
                    say(lock.acquire(timeout=1), lock.acquire(False), lock.acquire(True, 0))
                    later(1, lock.release)
                    say(lock.acquire())
            recursive = multiprocessing.RLock()
            with recursive, recursive:
                thread = threading.Thread(target=lambda: say(recursive.acquire(timeout=1)))
                thread.start()
                thread.join()
            condition = multiprocessing.Condition()
            def notify():
                with condition:
                    condition.notify_all()
            with condition:
                say(condition.wait(1), condition.wait_for(lambda: False, 1))
                later(1, notify)
                say(condition.wait(5))
            barrier = multiprocessing.Barrier(2)
            later(1, barrier.wait)
            say(barrier.wait() in (0, 1))
            try:
                barrier.wait(1)
            except threading.BrokenBarrierError:
                say("broken")
            number, numbers = multiprocessing.Value("i", 3), multiprocessing.Array("d", 2)
            with number.get_lock(), numbers.get_lock():
                number.value += 1
                thread = threading.Thread(target=lambda: say(number.get_lock().acquire(timeout=1)))
                thread.start()
                thread.join()
            say(number.value, numbers[:])
            """
        expected = ["2.000 False False", "3.000 True True"]
        for time in (3, 5, 7):
            expected += ["%d.000 False False False" % (time + 1), "%d.000 True" % (time + 2)]
        expected += ["10.000 False", "12.000 False False", "13.000 True", "14.000 True", "15.000 broken", "16.000 False", "16.000 4 [0.0, 0.0]"]
        self.assertEqual(self.said(text), expected)

    def test_semaphores_are_as_before(self):
        text = """
            import multiprocessing, threading
            def what(call):
                try:
                    return call()
                except Exception as error:
                    return "%s: %s" % (type(error).__name__, error)
            for lock in multiprocessing.Lock(), multiprocessing.RLock(), multiprocessing.Semaphore(2), multiprocessing.BoundedSemaphore(2):
                for call in (
                    lambda: lock, lambda: lock.release(), lambda: lock.acquire(), lambda: lock, lambda: lock.acquire(timeout=-1),
                    lambda: lock, lambda: lock.get_value(), lambda: lock.release(), lambda: lock, lambda: lock.release(),
                    lambda: lock.release(), lambda: lock, lambda: lock.acquire(timeout="a"), lambda: lock.__enter__(),
                    lambda: lock.__exit__(None, None, None),
                ):
                    print(what(call))
            for wrong in lambda: multiprocessing.Semaphore(-1), lambda: multiprocessing.Event().wait(0):
                print(what(wrong))
            print(multiprocessing.Lock, multiprocessing.synchronize.SEM_VALUE_MAX)
            """
        finished = run_text(text)
        self.assertEqual((finished.code, finished.err), (0, ""))
        plain = run_plain(text)
        without = [line for line in plain.splitlines() if not line.startswith("<bound method")]
        self.assertEqual([line for line in finished.out.splitlines() if not line.startswith("<bound method")], without)

    def test_asking_again_and_again_is_a_wait(self):
        text = """
            event, lock, items = multiprocessing.Event(), multiprocessing.Lock(), multiprocessing.Queue()
            lock.acquire()
            for ask, end in (
                (event.is_set, event.set), (lambda: lock.acquire(False), lock.release), (lambda: not items.empty(), lambda: items.put(1)),
            ):
                later(0.01, end)
                while not ask():
                    pass
                say("end")
            """
        times = [float(line.split()[0]) for line in self.said(text)]
        for turn, time in enumerate(times):
            self.assertTrue(0.01 * (turn + 1) <= time < 0.01 * (turn + 1) + 0.005 * (turn + 1), times)

    def test_processes_are_refused(self):
        text = """
            import concurrent.futures
            for start in (
                multiprocessing.Process(target=print).start, multiprocessing.Manager, lambda: multiprocessing.Pool(2),
                lambda: concurrent.futures.ProcessPoolExecutor(1).submit(print),
            ):
                try:
                    start()
                except RuntimeError as error:
                    say(type(error).__name__, str(error).split(";")[1])
            """
        told = "0.000 Unsupported  use threads (threading, concurrent.futures.ThreadPoolExecutor), or subprocess.run for a child that is waited for"
        self.assertEqual(self.said(text), [told] * 4)


if __name__ == "__main__":
    unittest.main()
