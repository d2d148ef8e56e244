"""What arrives while a program waits: events, ends of motions, messages, and answers."""

import os
import sys
import tempfile
import textwrap
import unittest

from harness import ROOT, Program, run_text
from system import System

SECOND = 10**9


def event(name, **args):
    return {"event": {"name": name, "args": args}}


class Case(unittest.TestCase):
    def said(self, text, system=None, **how):
        finished = run_text(text, system=system, **how)
        self.assertEqual((finished.code, finished.err), (0, ""), finished.err)
        return finished.out.splitlines()

    def failed(self, text, system=None):
        finished = run_text(text, system=system)
        self.assertEqual(finished.code, 1, finished.out)
        return finished.err


class Events(Case):
    def test_they_wait_for_who_takes_them(self):
        text = """
            import hrdsl
            node = hrdsl.Node("robot")
            node.sleep(3)
            print(node.wait_for("b", timeout=1), node.now())
            print(node.wait_for("a", "b"), node.wait_for("a", timeout=0), node.now())
            print(node.wait_for("a", timeout=2), node.now())
            print(node.wait_for("a", timeout=2), node.now())
            """
        arrivals = [(SECOND, event("a", n=1)), (2 * SECOND, event("b")), (5 * SECOND, event("a", n=2))]
        self.assertEqual(
            self.said(text, System(arrivals)),
            [
                "Event(b() at 2.000 s) 3.0",
                "Event(a(n=1) at 1.000 s) None 3.0",
                "Event(a(n=2) at 5.000 s) 5.0",  # at the very timeout
                "None 7.0",
            ],
        )

    def test_names_that_the_actor_does_not_hear_are_refused(self):
        text = """
            import hrdsl
            node = hrdsl.Node("robot")
            for wrong in (lambda: node.wait_for("a", "c"), lambda: node.drop("d"), lambda: node.wait_for()):
                try:
                    wrong()
                except hrdsl.ProtocolError as error:
                    print(error)
            print(node.wait_for("a"))
            """
        self.assertEqual(
            self.said(text, System([(0, event("a"))], events=["a"])),
            [
                "no event `c` that this actor hears",
                "no event `d` that this actor hears",
                "wait_for needs the name of an event",
                "Event(a() at 0.000 s)",
            ],
        )

    def test_dropped_and_lost(self):
        text = """
            import hrdsl
            node = hrdsl.Node("robot")
            node.sleep(1)
            node.drop("a")
            print(node.wait_for("a", "b").n)
            node.sleep(1)
            print(node.wait_for("b").n)
            node.drop()
            print(node.wait_for("a", "b", timeout=0))
            """
        arrivals = [(n, event("a" if n % 2 else "b", n=n)) for n in range(10)]
        arrivals += [(SECOND + n, event("b", n=n)) for n in range(1500)]
        self.assertEqual(self.said(text, System(arrivals)), ["0", "500", "None"])

    def test_two_threads_hear_each_their_own(self):
        text = """
            import hrdsl, threading
            node = hrdsl.Node("robot")
            def hear(name):
                print(name, node.wait_for(name, timeout=4), node.now())
            threads = [threading.Thread(target=hear, args=(name,)) for name in "aab"]
            for thread in threads:
                thread.start()
            node.sleep(1)
            print("slept", node.now())
            """
        arrivals = [(SECOND // 2, event("b")), (3 * SECOND, event("a"))]
        self.assertEqual(
            self.said(text, System(arrivals)),
            ["b Event(b() at 0.500 s) 0.5", "slept 1.0", "a Event(a() at 3.000 s) 3.0", "a None 4.0"],
        )

    def test_a_program_that_waits_for_nothing_that_can_come_is_told(self):
        text = """
            import hrdsl, threading
            node = hrdsl.Node("robot")
            threading.Event().wait()
            """
        self.assertIn("hrdsl: deadlock", self.failed(text))

    def test_the_test_ends_while_it_waits(self):
        text = """
            import hrdsl
            node = hrdsl.Node("robot")
            try:
                node.wait_for("a")
            finally:
                print("over", node._link.time)
            """
        self.assertEqual(self.said(text, System([(5, event("b"))])), ["over 5"])


class Motions(Case):
    def test_see_the_child_and_brake(self):
        text = """
            import hrdsl
            node = hrdsl.Node("robot")
            base = node.device("robot.base")
            drive = base.begin("drive", to=[1, 2], speed=None)
            print(drive, drive.wait(timeout=0.5), drive.done())
            found = node.wait_for("child_near", drive)
            print(found, found is not drive, node.now())
            print(base.command("brake"), node.now(), drive.done(), drive.error, drive.wait())
            drive = base.begin("drive")
            print(node.wait_for("child_near", drive, timeout=60) is drive, drive.error, node.now())
            """
        delays = {"drive": 5 * SECOND, "brake": SECOND}
        system = System([(2 * SECOND, event("child_near"))], commands=lambda act: (delays[act["do"]], None))
        self.assertEqual(
            self.said(text, system),
            [
                "Motion(drive of robot.base, under way) None False",
                "Event(child_near() at 2.000 s) True 2.0",
                "True 3.0 False None True",
                "True None 10.0",
            ],
        )

    def test_other_threads_run_while_one_waits_for_a_motion(self):
        text = """
            import hrdsl, threading, time
            node = hrdsl.Node("robot")
            def tick():
                for _ in range(3):
                    time.sleep(1)
                    print("tick", node.now())
            threading.Thread(target=tick).start()
            print(node.arm("robot.arm").move_joints([1]), node.arm("robot.arm").last_error, node.now())
            """
        system = System(commands=lambda act: (2 * SECOND + 5, "too far"))
        self.assertEqual(
            self.said(text, system), ["tick 1.0", "tick 2.0", "False too far 2.000000005", "tick 3.0"]
        )

    def test_one_that_cannot_be_begun(self):
        text = """
            import hrdsl
            node = hrdsl.Node("robot")
            motion = node.arm("robot.arm").begin("move_to", to=[1, 2, 3])
            print(motion, motion.done(), motion.wait())
            """
        system = System(commands=lambda act: (None, "the planner finds no way"))
        self.assertEqual(
            self.said(text, system), ["Motion(move_to of robot.arm, failed: the planner finds no way) True False"]
        )


class Ports(Case):
    def test_a_subscriber_hears_in_a_mailbox(self):
        text = """
            from hrdsl.exchange import the_exchange
            from hrdsl.mailbox import Mailbox
            exchange, box = the_exchange(), Mailbox()
            port = exchange.open("subscriber", "/a", "std_msgs/Int8", depth=2, handler=box.put)
            print(box.get(1000)), print(box.get()["message"], exchange.time, len(box), box.get(0))
            print(box.get(7 * 10**9)["message"], exchange.time)
            port.close()
            print(box.get(10**9), exchange.time)
            """
        arrivals = [(SECOND, {"topic": "/a", "message": 5}), (8 * SECOND, {"topic": "/a", "message": 6})]
        self.assertEqual(
            self.said(text, System(arrivals)), ["None", "5 1000000000 0 None", "6 8000000000", "None 9000000000"]
        )

    def test_publications_go_with_the_next_wait(self):
        text = """
            import time
            from hrdsl.exchange import the_exchange
            port = the_exchange().open("publisher", "/a", "T", latched=True)
            port.publish({"data": 1})
            port.publish(b'{"data":2}')
            time.sleep(1)
            port.publish({"data": 3})
            """
        system = System()
        self.said(text, system)
        self.assertEqual([(t, m["data"]) for t, _, m in system.published], [(0, 1), (0, 2), (SECOND, 3)])

    def test_what_is_refused_is_told_to_the_thread_that_asked(self):
        text = """
            import threading, time
            from hrdsl.errors import ProtocolError
            from hrdsl.exchange import Port, the_exchange
            exchange = the_exchange()
            port = Port(exchange, 77, "publisher", "/a", "T", None)
            def ask():
                port.publish(1)
                try:
                    time.sleep(5)
                except ProtocolError as error:
                    print("thread:", error, exchange.time)
            threading.Thread(target=ask).start()
            time.sleep(1)
            port.publish(2)
            try:
                exchange.open("publisher", "/b", "T")
            except ProtocolError as error:
                print("main:", error)
            try:
                port.publish(b" " * (1 << 20))
            except ProtocolError as error:
                print(error)
            """
        self.assertEqual(
            self.said(text),
            [
                "thread: publisher of /a (T): no port 77 is open 0",
                "main: publisher of /a (T): no port 77 is open",
                "publisher of /a (T): a message of 1048619 bytes as JSON; a request has at most 1048576"
                " (send less at once, such as smaller images)",
            ],
        )

    def test_a_service_on_both_sides(self):
        text = """
            import threading
            from hrdsl.exchange import the_exchange
            from hrdsl.mailbox import Mailbox
            exchange, asked, answers = the_exchange(), Mailbox(), Mailbox()
            client = exchange.open("client", "/add", "Add")
            client.call([1, 2], answers.put)
            print(answers.get())
            exchange.open("server", "/add", "Add", handler=asked.put)
            def serve():
                for _ in range(2):
                    call = asked.get()
                    exchange.respond(call["called"], sum(call["message"]))
                exchange.refuse(asked.get()["called"], "no more")
            threading.Thread(target=serve).start()
            for pair in ([1, 2], [3, 4], [5, 6]):
                client.call(pair, answers.put)
                print(answers.get())
            print([port["kind"] for port in exchange.listing()])
            """
        self.assertEqual(
            self.said(text),
            [
                "{'answered': 2, 'error': 'the service `/add` has no server'}",
                "{'answered': 4, 'message': 3}",
                "{'answered': 5, 'message': 7}",
                "{'answered': 6, 'error': 'no more'}",
                "['client', 'server']",
            ],
        )

    def test_a_goal_with_feedback_and_an_end(self):
        text = """
            from hrdsl.exchange import the_exchange
            from hrdsl.mailbox import Mailbox
            exchange, box = the_exchange(), Mailbox()
            port = exchange.open("action_client", "/go", "Go")
            port.call("home", box.put)
            for _ in range(3):
                print(box.get(), exchange.time)
            call = port.call("away", box.put)
            call.cancel()
            for _ in range(3):
                print(box.get(), exchange.time)
            call.cancel()
            port.cancel_all()
            """
        system = System(actions={"/go": lambda goal: [(10, 0.5), (20, "succeeded", goal)]})
        self.assertEqual(
            self.said(text, system),
            [
                "{'accepted': 2, 'text': 'it begins'} 0",
                "{'feedback': 2, 'message': 0.5} 10",
                "{'finished': 2, 'end': 'succeeded', 'message': 'home'} 20",
                "{'accepted': 3, 'text': 'it begins'} 20",
                "{'cancel_answered': 3, 'granted': True} 20",
                "{'finished': 3, 'end': 'canceled', 'message': None, 'text': 'as asked'} 20",
            ],
        )

    def test_the_server_of_an_action_says_what_becomes_of_goals(self):
        text = """
            from hrdsl.exchange import the_exchange
            from hrdsl.mailbox import Mailbox
            exchange, goals, told = the_exchange(), Mailbox(), Mailbox()
            exchange.open("action_server", "/go", "Go", handler=goals.put)
            port = exchange.open("action_client", "/go", "Go")
            calls = [port.call(name, told.put) for name in ("home", "away")]
            numbers = [goals.get()["called"], goals.get()["called"]]
            exchange.accept(numbers[0], "50 % sure")
            exchange.finish(numbers[1], "rejected", None, "100 % \\"wrong\\"")
            calls[0].cancel()
            print(goals.get())
            exchange.answer_cancel(numbers[0], False, "nearly there")
            exchange.finish(numbers[0], "succeeded", 3)
            for _ in range(4):
                print(told.get())
            """
        self.assertEqual(
            self.said(text),
            [
                "{'canceled': 1, 'port': 1}",
                "{'accepted': 3, 'text': '50 % sure'}",
                "{'finished': 4, 'end': 'rejected', 'message': None, 'text': '100 % \"wrong\"'}",
                "{'cancel_answered': 3, 'granted': False, 'text': 'nearly there'}",
                "{'finished': 3, 'end': 'succeeded', 'message': 3}",
            ],
        )

    def test_changes_of_the_graph(self):
        text = """
            from hrdsl.exchange import the_exchange
            from hrdsl.mailbox import Mailbox
            exchange, box = the_exchange(), Mailbox()
            exchange.on_change(lambda: box.put("changed"))
            print(exchange.listing())
            print(box.get(), exchange.time, exchange.listing())
            """
        system = System([(5, lambda system: system.others_open("server", "/add", "Add"))])
        self.assertEqual(
            self.said(text, system),
            ["[]", "changed 5 [{'kind': 'server', 'name': '/add', 'type': 'Add', 'program': 'other'}]"],
        )


class Polls(Case):
    def test_a_loop_that_polls_lets_time_pass(self):
        text = """
            from hrdsl.exchange import the_exchange
            from hrdsl.mailbox import Mailbox
            exchange, box = the_exchange(), Mailbox()
            exchange.open("subscriber", "/a", "T", handler=box.put)
            while box.get(0) is None:
                pass
            print(exchange.time)
            """
        self.assertEqual(self.said(text, System([(5000000, {"topic": "/a", "message": 5})])), ["6000000"])


class Plainly(Program):
    """A program that is not started by the runner."""

    def command(self, words, options):
        return [sys.executable, *words]


class Plain(Case):
    def test_without_the_runner_it_works_too(self):
        text = """
            import sys; sys.path.insert(0, %r)
            import threading, hrdsl
            node = hrdsl.Node("robot")
            print(node.wait_for("a", timeout=3), node.now(), flush=True)
            thread = threading.Thread(target=lambda: print(node.wait_for("a", timeout=3), node.now()))
            thread.start()
            thread.join()
            node.sleep(1)
            """
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "plain.py")
            with open(path, "w") as file:
                file.write(textwrap.dedent(text) % ROOT)
            finished = Plainly([path], system=System([(SECOND, event("a")), (2 * SECOND, event("a"))])).finish()
        self.assertEqual((finished.code, finished.err), (0, ""))
        self.assertEqual(finished.out, "Event(a() at 1.000 s) 1.0\nEvent(a() at 2.000 s) 2.0\n")
        self.assertEqual(finished.requests[-1], {"request": "done"})


if __name__ == "__main__":
    unittest.main()
