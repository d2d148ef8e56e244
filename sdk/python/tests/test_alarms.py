"""Signals that a program asks to be sent later: in simulated time, handled by the main thread."""

import textwrap
import unittest

from harness import run_text

SAY = """
import signal, threading, time
def say(*what):
    print("%.3f" % time.monotonic(), *what)
def handler(number, frame):
    say("handler", signal.Signals(number).name, threading.current_thread().name)
signal.signal(signal.SIGALRM, handler)
"""


class Alarms(unittest.TestCase):
    def said(self, text, code=0):
        finished = run_text(SAY + textwrap.dedent(text))
        self.assertEqual((finished.code, finished.err), (code, ""))
        return finished.out.splitlines()

    def test_an_alarm_comes_in_simulated_time(self):
        text = """
            say(signal.alarm(2))
            time.sleep(1.5)
            say(signal.alarm(3))
            time.sleep(4)
            signal.alarm(5)
            time.sleep(1)
            say(signal.alarm(0))
            time.sleep(9)
            say("end")
            """
        self.assertEqual(self.said(text), ["0.000 0", "1.500 1", "4.500 handler SIGALRM MainThread", "6.500 4", "15.500 end"])

    def test_a_timer_comes_again(self):
        text = """
            say(signal.setitimer(signal.ITIMER_REAL, 0.5, 0.25))
            signal.pause()
            signal.pause()
            say(signal.getitimer(signal.ITIMER_REAL))
            say(signal.setitimer(signal.ITIMER_REAL, 0), signal.getitimer(signal.ITIMER_REAL))
            time.sleep(2)
            say("end")
            """
        handled = "handler SIGALRM MainThread"
        expected = ["0.000 (0.0, 0.0)", "0.500 " + handled, "0.750 " + handled, "0.750 (0.25, 0.25)", "0.750 (0.25, 0.25) (0.0, 0.0)", "2.750 end"]
        self.assertEqual(self.said(text), expected)

    def test_its_exception_ends_waits_and_polls_of_the_main_thread(self):
        text = """
            import asyncio, queue
            class Late(Exception):
                pass
            def handler(*_):
                raise Late
            signal.signal(signal.SIGALRM, handler)
            def poll():
                while True:
                    time.time()
            def sleep():
                time.sleep(9)
            lock = threading.Lock()
            lock.acquire()
            for wait in sleep, poll, lock.acquire, threading.Event().wait, queue.Queue().get:
                signal.alarm(1)
                try:
                    wait()
                except Late:
                    say(wait.__name__)
            """
        names = ("sleep", "poll", "acquire", "wait", "get")
        self.assertEqual(self.said(text), ["%d.000 %s" % (place + 1, name) for place, name in enumerate(names)])

    def test_without_a_handler_it_ends_the_program(self):
        finished = run_text("import signal, time\nsignal.alarm(2)\ntime.sleep(1)\nprint(time.time(), flush=True)\ntime.sleep(9)")
        self.assertEqual((finished.code, finished.out), (-14, "1735689601.0\n"))

    def test_one_that_is_set_keeps_no_program_from_ending(self):
        self.assertEqual(self.said("signal.alarm(9)\nsay('end')"), ["0.000 end"])

    def test_a_signal_of_another_thread_ends_a_pause(self):
        text = """
            def send():
                time.sleep(1)
                signal.raise_signal(signal.SIGALRM)
            threading.Thread(target=send).start()
            signal.pause()
            say("end")
            """
        self.assertEqual(self.said(text), ["1.000 handler SIGALRM MainThread", "1.000 end"])

    def test_what_depends_on_the_machine_is_refused(self):
        text = """
            for call in (
                lambda: signal.sigtimedwait([signal.SIGALRM], 1), lambda: signal.sigwait([signal.SIGALRM]),
                lambda: signal.sigwaitinfo([signal.SIGALRM]), lambda: signal.setitimer(signal.ITIMER_PROF, 1),
                lambda: signal.getitimer(signal.ITIMER_VIRTUAL), lambda: signal.setitimer(signal.ITIMER_REAL, -1),
                lambda: signal.setitimer(7, 1),
            ):
                try:
                    call()
                except Exception as error:
                    print(type(error).__name__, error)
            def elsewhere():
                try:
                    signal.pause()
                except RuntimeError as error:
                    print(error)
            thread = threading.Thread(target=elsewhere)
            thread.start()
            thread.join()
            """
        said = self.said(text)
        for line, name in zip(said, ("sigtimedwait", "sigwait", "sigwaitinfo")):
            self.assertEqual(
                line,
                "Unsupported signal.%s waits in real time, beside the simulated one; handle the signal with signal.signal, and wait with"
                " signal.pause or time.sleep" % name,
            )
        self.assertTrue(said[3] == said[4] and said[3].endswith("use ITIMER_REAL"), said[3:5])
        self.assertEqual(said[5:7], ["itimer_error [Errno 22] Invalid argument"] * 2)
        self.assertIn("signal.pause in another thread", said[7])


if __name__ == "__main__":
    unittest.main()
