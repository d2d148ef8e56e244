"""The scheduler without a harness: who runs when, and what ends a wait."""

import sys
import unittest

from harness import ROOT

sys.path.insert(0, ROOT)

from hrdsl import locks, threads  # noqa: E402
from hrdsl.errors import Deadlock, Stopped  # noqa: E402
from hrdsl.schedule import POLLS, STEP, Scheduler  # noqa: E402


class Outside:
    """Time passes at once. `arrivals` are calls by their times."""

    def __init__(self):
        self.time, self.stopped, self.arrivals, self.waits = 0, False, {}, []

    def wait(self, until, give_up):
        limit = min((time for time in (until, give_up) if time is not None), default=None)
        self.waits.append(limit)
        times = [time for time in self.arrivals if limit is None or time < limit or time == give_up != until]
        if times:
            self.time = min(times)
            self.arrivals.pop(self.time)()
        elif self.stopped:
            raise Stopped()
        elif limit is None:
            raise Deadlock()
        else:
            self.time = limit
            return until is None or give_up is not None and give_up < until
        return False

    def can_arrive(self):
        return bool(self.arrivals)


class Case(unittest.TestCase):
    def setUp(self):
        self.outside = Outside()
        self.make(None)

    def make(self, seed):
        self.scheduler = Scheduler(self.outside, seed)
        locks.use(self.scheduler)
        self.threads = threads.Threads(self.scheduler)
        self.said = []

    def say(self, *what):
        self.said.append((self.outside.time, *what))

    def start(self, function, *args):
        return self.threads.start(function, args, {})

    def join_all(self):
        while len(self.scheduler.tasks) > 1:
            self.scheduler.park("join", self.outside.time + 10**9)


class Order(Case):
    def test_first_come_first_served(self):
        for name in "abc":
            self.start(self.yields, name)
        self.join_all()
        self.assertEqual([name for _, name in self.said], list("abcabc"))

    def yields(self, name):
        for _ in range(2):
            self.say(name)
            self.scheduler.yield_()

    def test_deadlines_by_time_and_then_by_arrival(self):
        def wait(name, seconds):
            self.scheduler.sleep(seconds)
            self.say(name)

        for name, seconds in (("a", 2), ("b", 1), ("c", 2), ("d", 1), ("e", 0.5)):
            self.start(wait, name, seconds)
        self.join_all()
        second = 10**9
        self.assertEqual(
            self.said, [(second // 2, "e"), (second, "b"), (second, "d"), (2 * second, "a"), (2 * second, "c")]
        )

    def test_all_wait_for_one_request(self):
        for _ in range(5):
            self.start(self.scheduler.sleep, 1)
        self.scheduler.sleep(1)
        self.assertEqual(self.outside.waits, [10**9])

    def test_a_lock_goes_to_who_waits_for_longest(self):
        lock = locks.lock()

        def take(name):
            with lock:
                self.say(name)
                self.scheduler.sleep(1)

        lock.acquire()
        for name in "abc":
            self.start(take, name)
        self.scheduler.sleep(1)
        lock.release()
        lock.acquire()  # queues behind them, though it has just had it
        self.say("main")
        self.assertEqual([name for _, name in self.said], ["a", "b", "c", "main"])

    def test_a_seed_chooses_and_chooses_again(self):
        orders = {}
        for seed in [*range(8), *range(8)]:
            self.make(seed)
            for name in "abc":
                self.start(self.yields, name)
            self.join_all()
            orders.setdefault(seed, set()).add("".join(name for _, name in self.said))
        self.assertTrue(all(len(found) == 1 for found in orders.values()), orders)
        self.assertGreater(len(set.union(*orders.values())), 3)


class Waits(Case):
    def test_unparked_or_too_late(self):
        main = self.scheduler.current()

        def wake(seconds):
            self.scheduler.sleep(seconds)
            self.scheduler.unpark(main)

        self.start(wake, 1)
        self.assertIs(self.scheduler.park("it", 2 * 10**9), True)
        self.assertEqual(self.outside.time, 10**9)
        self.start(wake, 3)
        self.assertIs(self.scheduler.park("it", 2 * 10**9), False)
        self.join_all()

    def test_an_arrival_ends_a_wait(self):
        main = self.scheduler.current()
        self.outside.arrivals[7] = lambda: self.scheduler.unpark(main)
        self.assertIs(self.scheduler.park("a message"), True)
        self.assertEqual((self.outside.time, self.outside.waits), (7, [None]))

    def test_an_arrival_before_the_deadline(self):
        main = self.scheduler.current()
        self.outside.arrivals[7] = lambda: self.scheduler.unpark(main)
        self.assertIs(self.scheduler.park("a message", 50), True)
        self.assertEqual((self.outside.time, self.outside.waits), (7, [50]))
        self.assertIs(self.scheduler.park("another", 60), False)

    def test_who_is_patient_hears_what_comes_at_the_very_deadline(self):
        main = self.scheduler.current()
        self.outside.arrivals[50] = lambda: self.scheduler.unpark(main)
        self.assertIs(self.scheduler.park("a message", 50, True), True)
        self.assertIs(self.scheduler.park("another", 60, True), False)
        self.assertEqual((self.outside.time, self.outside.waits), (60, [50, 60]))

    def test_at_one_instant_pauses_end_before_patience(self):
        def sleep():
            self.scheduler.park("sleep", 50)
            self.say("slept")
            self.scheduler.unpark(main)

        main = self.scheduler.current()
        self.start(sleep)
        self.assertIs(self.scheduler.park("a message", 50, True), True)
        self.assertEqual(self.said, [(50, "slept")])
        self.join_all()

    def test_a_fault_of_the_outside_is_raised_by_the_wait_that_it_is_about(self):
        def fail(until, give_up):
            raise ValueError(until)

        def wait():
            with self.assertRaises(ValueError):
                self.scheduler.sleep(1)
            self.say("failed")
            self.scheduler.unpark(main)

        main = self.scheduler.current()
        self.start(wait)
        self.outside.wait = fail
        self.assertIs(self.scheduler.park("the other"), True)
        self.assertEqual(self.said, [(0, "failed")])
        self.join_all_ended()

    def join_all_ended(self):
        while len(self.scheduler.tasks) > 1:
            self.scheduler.yield_()

    def test_of_a_stop_the_main_thread_learns_last(self):
        def wait(name):
            try:
                self.scheduler.park(name)
            except Stopped:
                self.say(name)
                raise

        for name in "ab":
            self.start(wait, name)
        self.outside.stopped = True
        with self.assertRaises(Stopped):
            self.scheduler.park("main")
        self.assertEqual([name for _, name in self.said], ["a", "b"])
        self.assertFalse(self.scheduler.failed)

    def test_of_a_deadlock_it_learns_first(self):
        def wait():
            try:
                self.scheduler.park("worker")
            except Deadlock:
                self.say("worker")
                self.scheduler.unpark(main)
                raise

        main = self.scheduler.current()
        self.start(wait)
        text = self.caught(lambda: self.scheduler.park("main"))
        self.assertEqual(self.said, [])
        self.assertIn("deadlock", text)
        self.assertTrue(self.scheduler.failed)
        self.assertIs(self.scheduler.park("the worker"), True)
        self.assertEqual(self.said, [(0, "worker")])

    def caught(self, call):
        class Text(list):
            write = list.append

            def flush(self):
                pass

        before, sys.stderr = sys.stderr, Text()
        try:
            with self.assertRaises(Deadlock):
                call()
            return "".join(sys.stderr)
        finally:
            sys.stderr = before


class Polls(Case):
    def test_many_polls_of_one_thread_are_a_short_wait(self):
        for _ in range(3 * POLLS):
            self.scheduler.polled("test")
        # The first thousand show that the time stands still.
        self.assertEqual(self.outside.time, 2 * STEP)

    def test_first_the_others_run_at_the_same_instant(self):
        def other():
            self.say("other")
            self.found = True

        self.found = False
        self.start(other)
        while not self.found:
            self.scheduler.polled("test")
        self.assertEqual(self.said, [(0, "other")])

    def test_two_that_poll_let_time_pass(self):
        def poll():
            while self.outside.time < 5 * STEP:
                self.scheduler.polled("test")

        self.start(poll)
        poll()
        self.assertEqual(self.outside.time, 5 * STEP)
        self.join_all()

    def test_a_wait_between_polls_starts_the_count_anew(self):
        for _ in range(10):
            for _ in range(POLLS // 2):
                self.scheduler.polled("test")
            self.scheduler.sleep(1)
        self.assertEqual(self.outside.time, 10 * 10**9)

    def test_sleeps_of_no_time_are_polls(self):
        for _ in range(3 * POLLS):
            self.scheduler.sleep(0)
        self.assertGreater(self.outside.time, 0)


if __name__ == "__main__":
    unittest.main()
