"""The fork server: each run comes from the same state, and nothing that an import leaves behind is there before the test."""

import ctypes
import json
import os
import socket
import subprocess
import sys
import tempfile
import textwrap
import threading
import unittest

import ros2_table
import tables
from harness import ROOT, RUNNER
from system import System
from test_cover import PACKAGE, is_installed

#: Of personality(2): the addresses are the same in every run.
NO_RANDOM_ADDRESSES = 0x0040000

#: In the place of the supervisor of a cell: lets the program begin, and tells how it ends.
SUPERVISOR = """
import os, socket, sys
program, go = int(sys.argv[1]), int(sys.argv[2])
os.write(go, b"+")
_, status = os.waitpid(program, 0)
os.write(0, b"%d" % status)
"""


class Server:
    """A fork server for a program in a folder, without namespaces."""

    def __init__(self, folder, words=("program.py",), modules=None, coverage=(), variables=()):
        self.orders, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.folder = folder
        script = os.path.join(folder, ".supervisor.py")
        with open(script, "w") as file:
            file.write(SUPERVISOR)
        supervisor = os.open(sys.executable, os.O_RDONLY)
        cell = {"supervisor": supervisor, "words": [sys.executable, script], "namespaces": 0, "beyond": 0}
        env = {key: value for key, value in os.environ.items() if not key.startswith("HRDSL_")}
        env.update(
            PYTHONHASHSEED="3",
            TZ="UTC",
            HRDSL_FORK_SERVER=str(theirs.fileno()),
            HRDSL_FORK_CELL=json.dumps(cell),
            HRDSL_FORK_MODULES=json.dumps({"own": [folder], "preload": modules}),
            HRDSL_SYS_PATH=os.pathsep.join(sys.path[1:]),
            HRDSL_COVERAGE_PACKAGE=PACKAGE,
        )
        env.update(variables)
        options = [word for name in coverage for word in ("--coverage", name)]
        self.process = subprocess.Popen(
            [sys.executable, "-S", RUNNER, *options, *words],
            pass_fds=(theirs.fileno(), supervisor), env=env, cwd=folder, stderr=subprocess.PIPE,
            preexec_fn=lambda: ctypes.CDLL(None).personality(NO_RANDOM_ADDRESSES),
        )  # fmt: skip
        theirs.close()
        os.close(supervisor)
        said = self.orders.recv(1 << 16)
        self.modules = json.loads(said.decode())["modules"] if said else None

    def run(self, seed=1, coverage=False):
        """A run: its output, the status it ended with, and its coverage."""
        control, its_control = socket.socketpair()
        requests, its_requests = os.pipe()
        its_replies, replies = os.pipe()
        reading, writing = os.pipe()
        with tempfile.TemporaryFile() as memory:
            given = [its_control.fileno(), writing, writing, its_requests, its_replies, *([memory.fileno()] if coverage else [])]
            socket.send_fds(self.orders, [json.dumps({"seed": seed}).encode()], given)
            its_control.close()
            for descriptor in (writing, its_requests, its_replies):
                os.close(descriptor)
            answering = threading.Thread(target=answer, args=(requests, replies))
            answering.start()
            with open(reading, "rb") as output:
                text = output.read().decode()
            status = control.recv(100).decode()
            answering.join()
            control.close()
            memory.seek(0)
            measured = memory.read().decode()
        return text, status, json.loads(measured) if measured else None

    def close(self):
        self.orders.close()
        _, said = self.process.communicate()
        return said.decode()


def answer(requests, replies):
    system = System()
    with os.fdopen(requests) as lines:
        for line in lines:
            reply = system.answer(line)
            if reply is not None:
                os.write(replies, (json.dumps(reply) + "\n").encode())
    os.close(replies)


class ForkServer(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = os.path.realpath(folder.name)

    def write(self, name, text):
        path = os.path.join(self.folder, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w") as file:
            file.write(textwrap.dedent(text))

    def serve(self, text, **how):
        self.write("program.py", text)
        server = Server(self.folder, **how)
        self.addCleanup(server.process.wait)
        self.addCleanup(server.process.stderr.close)
        self.addCleanup(server.orders.close)
        return server

    def test_client_libraries_and_messages_are_found(self):
        for ros, text in (
            ("ros1", "import rospy\nfrom std_msgs.msg import Bool\nfrom std_srvs.srv import Trigger"),
            ("ros2", "import rclpy\nfrom rclpy.node import Node\nfrom std_msgs.msg import Bool"),
        ):
            path = os.path.join(self.folder, "binding.json")
            made = tables.table(["std_msgs", "std_srvs", "rosgraph_msgs"]) if ros == "ros1" else ros2_table.table()
            with open(path, "w") as file:
                json.dump({"ros": int(ros[3]), "interfaces": made}, file)
            libraries = os.pathsep.join([os.path.join(ROOT, ros), *sys.path[1:]])
            variables = {"HRDSL_MIDDLEWARE": ros, "HRDSL_BINDING": path, "HRDSL_SYS_PATH": libraries}
            with self.subTest(ros):
                server = self.serve(text, variables=variables)
                self.assertEqual(server.modules, [line.split()[1] for line in text.split("\n")])

    def test_runs_of_a_seed_are_the_same_whatever_ran_before(self):
        text = """
            import os, random, sys, threading, time, uuid
            import hrdsl
            node = hrdsl.Node("robot")
            found = {name: id(module) for name, module in sorted(sys.modules.items())}
            print(random.random(), random.Random().random(), uuid.uuid4(), os.urandom(4), os.environ["HRDSL_SEED"])
            print(time.time(), threading.get_native_id(), id(object()), hash("text"), {"a", "b", "c"})
            print(sorted(os.listdir("/proc/self/fd"))[:6], os.getcwd(), hash(frozenset(found.items())))
            node.sleep(2.5)
            print(time.monotonic(), set(map(object.__hash__, [object() for _ in range(5)])))
            __import__('posix').fork() or os._exit(0)
            """
        server = self.serve(text)
        self.assertEqual(server.modules, ["random", "threading", "uuid"])
        first = server.run(1)
        self.assertEqual(first[1], "0", first)
        self.assertNotEqual(server.run(2)[0], first[0])
        for _ in range(10):
            last = server.run(1)
        self.assertEqual(last, first)
        self.assertEqual(server.close(), "")
        self.assertEqual(self.serve(text, modules=server.modules).run(1)[0].splitlines()[0], first[0].splitlines()[0])

    def test_a_server_with_given_modules_is_the_same_as_another(self):
        text = "import json, random, hrdsl\nhrdsl.Node('robot')\nprint(id(json), id(object()), random.random())\n"
        # The first may compile what of the SDK was never imported before, the others find it compiled.
        servers = [self.serve(text, modules=["random", "hrdsl"]) for _ in range(3)][1:]
        runs = [server.run(5)[0] for server in servers]
        self.assertEqual(runs[0], runs[1])

    def test_what_a_compilation_says_is_said_in_each_run(self):
        server = self.serve("import hrdsl\nhrdsl.Node('robot')\nprint(len('a') is 1)\n", modules=[])
        runs = [server.run(5) for _ in range(2)]
        self.assertEqual(runs[0], runs[1])
        self.assertIn("SyntaxWarning", runs[0][0])
        self.assertEqual(server.close(), "")
        broken = self.serve("import hrdsl\nthis is no Python\n", modules=[]).run(5)
        self.assertEqual(broken[1], "256", broken)
        self.assertIn("SyntaxError", broken[0])

    def test_chance_is_that_of_a_fresh_process(self):
        text = "import random\nimport hrdsl\nhrdsl.Node('robot')\nprint(random.random(), random.Random().random())\n"
        preloaded, fresh = (self.serve(text, modules=modules) for modules in (["random"], []))
        self.assertEqual(preloaded.run(9)[0], fresh.run(9)[0])

    def test_imports_that_leave_something_behind_are_left_to_the_tests(self):
        own = {
            "opens.py": "file = open('/dev/null')\n",
            "writes.py": "open('/tmp/hrdsl-written', 'a').close()\n",
            "starts.py": "import threading\nthreading.Thread(target=threading.Event().wait, daemon=True).start()\n",
            "draws.py": "import os\nseed = os.urandom(4)\n",
            "prints.py": "print('hello')\n",
            "fails.py": "raise ImportError('never')\n",
            "leaves.py": "import os\nos._exit(0)\n",
            "asks.py": "import hrdsl\nhrdsl.Node('robot')\n",
            "waits.py": "import time\ntime.sleep(1)\n",
            "changes.py": "import os\nos.environ['CHANGED'] = '1'\n",
            "moves.py": "import os\nos.chdir('/')\n",
            "catches.py": "import signal\nsignal.signal(signal.SIGUSR1, print)\n",
            "uses_own.py": "import helper\n",
            "good.py": "import random, logging\nchosen = random.Random(3).random()\n",
        }
        for name, text in own.items():
            self.write(os.path.join("site-packages", name), text)
        self.write("helper.py", "pass\n")
        names = [name[:-3] for name in own]
        sys.path.insert(1, os.path.join(self.folder, "site-packages"))
        try:
            server = self.serve("import helper\n%s\n" % "\n".join("import " + name for name in names))
        finally:
            del sys.path[1]
        self.assertEqual(server.modules, ["good"])
        self.assertFalse(os.path.exists("/tmp/hrdsl-written"))

    def test_a_module_that_the_server_needs_is_not_taken_from_the_project(self):
        self.write("ctypes.py", "own = True\n")
        server = self.serve("import ctypes\nprint(ctypes.own)\n")
        self.assertIsNone(server.modules)
        self.assertEqual(server.close(), "the project has a module `ctypes`, which a fork server needs itself\n")

    @unittest.skipUnless(is_installed(), "coverage.py is not installed")
    def test_code_of_the_project_is_imported_in_the_run_and_measured(self):
        self.write("helper.py", "import os\nprint('imported', os.getpid() != %d)\n" % os.getpid())
        server = self.serve("import helper\nimport hrdsl\nhrdsl.Node('robot')\n", coverage=["program.py", "helper.py"])
        self.assertEqual(server.modules, [])
        for _ in range(2):
            text, status, measured = server.run(coverage=True)
            self.assertEqual((text, status), ("imported True\n", "0"))
            self.assertEqual(measured["program.py"]["executed"], [1, 2, 3])
            self.assertEqual(measured["helper.py"]["executed"], [1, 2])

    def test_what_a_run_does_to_itself_hurts_no_other(self):
        text = """
            import os, signal
            import hrdsl
            node = hrdsl.Node("robot")
            if node._link and os.environ["HRDSL_SEED"] == "1":
                os.killpg(0, signal.SIGKILL)
            if os.environ["HRDSL_SEED"] == "2":
                os.closerange(0, 100)
                os._exit(3)
            print("well")
            """
        server = self.serve(text)
        self.assertEqual([server.run(seed)[:2] for seed in (1, 2, 3)], [("", "9"), ("", "768"), ("well\n", "0")])


if __name__ == "__main__":
    unittest.main()
