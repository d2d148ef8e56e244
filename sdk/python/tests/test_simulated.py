"""What programs see of time, chance and the machine: as real as before, but for its values."""

import os
import sys
import tempfile
import textwrap
import unittest

from harness import ROOT, run

sys.path.insert(0, ROOT)

from hrdsl import files  # noqa: E402


class Case(unittest.TestCase):
    def program(self, text, seed=17, name="program.py"):
        """Runs a program in a folder of its own; it fails by an exception."""
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, name)
            with open(path, "w") as file:
                file.write("import os, sys, time\nos.chdir(%r)\n%s" % (folder, textwrap.dedent(text)))
            finished = run([path], seed=seed)
        self.assertEqual((finished.code, finished.err), (0, ""))
        return finished.out


class Simulated(Case):
    def test_generators_without_a_seed_follow_the_test_s(self):
        text = """
            import random, _random
            class Mine(random.Random):
                def __init__(self, name, x=None):
                    self.name = name
                    super().__init__(x)
            again = random.Random(5)
            again.seed()
            random.seed()
            print(random.random(), random.Random().random(), again.random(), random.Random(None).random())
            print(_random.Random().random(), Mine(None).random(), random.SystemRandom().randint(0, 2**64))
            """
        self.assertEqual(self.program(text), self.program(text))
        first, other = self.program(text).split(), self.program(text, seed=18).split()
        self.assertEqual(len(set(first + other)), 14, "no two are equal")

    def test_the_stream_of_the_module_is_no_other_s(self):
        out = self.program("import random\nprint(random.getrandbits(32), int.from_bytes(os.urandom(4), 'little'))")
        self.assertEqual(len(set(out.split())), 2)

    def test_who_imports_what_first_changes_no_chance(self):
        text = "import random, uuid\nprint(os.urandom(4), random.random(), random.Random().random(), uuid.uuid4())"
        self.assertEqual(self.program(text), self.program("import tempfile, pdb, ssl, uuid, random\n" + text))
        text = text.replace("import random, uuid\nprint(", "x = os.urandom(4)\nimport random, uuid\nprint(x, ").replace("os.urandom(4), r", "r")
        self.assertEqual(self.program(text), self.program("import random\n" + text))

    def test_generators_with_a_seed_are_python_s_own(self):
        text = "import random\nx = random.Random(5)\nprint(x.random(), x.gauss(0, 1), x.choice('abc'), x.sample(range(9), 4))"
        space = {}
        with tempfile.TemporaryFile("w+") as file:
            exec(text.replace("print(", "found = ("), space)
            print(*space["found"], file=file)
            file.seek(0)
            self.assertEqual(self.program(text), file.read())
        self.program(
            """
            import _random, copy, pickle, random
            for x in random.Random(), random.Random(5), random.Random("text"):
                for y in copy.copy(x), copy.deepcopy(x), pickle.loads(pickle.dumps(x)):
                    assert type(y) is random.Random and y.getstate() == x.getstate()
            assert isinstance(x, _random.Random) and issubclass(random.SystemRandom, _random.Random)
            class Half(random.Random):
                def random(self):
                    return 0.5
            assert Half(1).uniform(2, 4) == 3 and Half().choice("abcd") == "a"
            for wrong in (lambda: random.Random(1, 2), lambda: _random.Random([]), lambda: os.urandom(-1)):
                try:
                    wrong()
                except (TypeError, ValueError):
                    continue
                raise AssertionError("accepted")
            assert os.urandom(0) == b"" and len(os.urandom(7)) == 7
            """
        )

    def test_what_is_forked_past_the_refusal_has_chances_of_its_own(self):
        text = """
            import posix, random
            read, write = os.pipe()
            for _ in range(2):
                child = posix.fork()
                if not child:
                    os.write(write, b"%s %s\\n" % (str(random.random()).encode(), os.urandom(3).hex().encode()))
                    os._exit(0)
                os.waitpid(child, 0)
            print(os.read(read, 999).decode(), random.random(), os.urandom(3).hex())
            """
        self.assertEqual(self.program(text), self.program(text))
        self.assertEqual(len(set(self.program(text).split())), 6)

    def test_a_forked_process_makes_no_requests(self):
        out = self.program(
            """
            import posix
            import hrdsl
            node = hrdsl.Node("parent")
            for ask in (node.now, lambda: time.sleep(1), lambda: hrdsl.Node("child"), lambda: sys.exit(0), lambda: None):
                sys.stdout.flush()
                child = posix.fork()
                if child == 0:
                    try:
                        ask()
                    except hrdsl.ProtocolError as error:
                        print(error)
                    break
                assert os.waitpid(child, 0)[1] == 0
                assert node.now() == 0.0
            """
        )
        self.assertEqual(out.count("a process forked from the program cannot make requests"), 3)

    def test_a_process_that_it_starts_hashes_alike_and_is_told_why_it_has_no_node(self):
        out = self.program(
            """
            import subprocess
            import hrdsl
            text = "import sys; print(hash('text')); sys.path.append(%r); import hrdsl; hrdsl.Node('x')"
            text %= os.path.dirname(os.path.dirname(hrdsl.__file__))
            done = subprocess.run([sys.executable, "-c", text], stdout=-1, stderr=-1, universal_newlines=True)
            assert done.stdout == "%d\\n" % hash("text"), done
            print(done.stderr.splitlines()[-1])
            """
        )
        self.assertIn("ProtocolError: a process started by the program has no connection to the harness", out)

    def test_a_process_that_it_starts_sees_the_machine_s_clock_and_the_test_s_seed(self):
        out = self.program(
            """
            import subprocess
            ask = "import os, random, time; print(sorted(n for n in os.environ if n.startswith('HRDSL')), os.environ['HRDSL_SEED']);"
            ask += "print(time.time() > %r, time.monotonic() > 0, random.Random().random())" % (time.time() + 1)
            for _ in range(2):
                print(subprocess.check_output([sys.executable, "-c", ask], universal_newlines=True), end="")
            print(time.time(), time.monotonic())
            """
        )
        lines = out.splitlines()
        self.assertEqual((lines[0], lines[4]), ("['HRDSL_SEED'] 17", "1735689600.0 0.0"))
        self.assertEqual([line.rpartition(" ")[0] for line in (lines[1], lines[3])], ["True True"] * 2)
        self.assertNotEqual(lines[1], lines[3], "entropy is the machine's")

    def test_modules_are_themselves_after_the_patch(self):
        self.program(
            """
            import inspect, json, random, uuid
            for module in random, uuid:
                assert type(module.__loader__) is type(json.__loader__)
                assert module.__spec__.loader is module.__loader__ and module.__name__ in inspect.getsource(module)
            import importlib
            before = random.random()
            importlib.reload(random)
            assert random.random() == before
            """
        )

    def test_files_of_the_program_may_have_names_of_the_library(self):
        self.program(
            """
            names = ["random", "uuid", "resource", "pdb", "datetime"]
            for name in names:
                with open(name + ".py", "w") as file:
                    file.write("seed = Random = date = None")
            for name in names:
                assert __import__(name).__file__ == os.path.realpath(name + ".py") and __import__(name).seed is None
            """
        )

    def test_functions_stay_built_in(self):
        self.program(
            """
            import copy, os, pickle
            class Clock:
                now, sleep, listdir = time.monotonic, time.sleep, os.listdir
            assert Clock().now() == 0.0 and Clock().listdir(".") == ["program.py"] and Clock().sleep(1) is None
            for function in time.time, time.sleep, os.stat, os.urandom, os.cpu_count:
                assert pickle.loads(pickle.dumps(function)) is function and copy.deepcopy(function) is function
                assert repr(function) == "<built-in function %s>" % function.__name__ and function.__doc__
            assert os.stat in os.supports_fd and os.scandir in os.supports_fd and os.stat in os.supports_follow_symlinks
            import shutil
            os.makedirs("a/b/c")
            assert shutil.rmtree.avoids_symlink_attacks
            shutil.rmtree("a")
            """
        )

    def test_dates_are_pickled_and_compared(self):
        self.program(
            """
            import copy, datetime, pickle
            real = datetime.datetime.__mro__[1]
            made_in_c = real(2020, 1, 2, 3, 4, 5, 6, tzinfo=datetime.timezone.utc, fold=1)
            now = datetime.datetime.now()
            assert repr(now) == "datetime.datetime(2025, 1, 1, 0, 0)" and type(now.date()) is datetime.date
            for x in made_in_c, made_in_c.date(), now, now.date(), datetime.datetime.min, datetime.date.max:
                assert isinstance(x, datetime.date)
                for y in [copy.copy(x)] + [pickle.loads(pickle.dumps(x, p)) for p in range(pickle.HIGHEST_PROTOCOL + 1)]:
                    assert y == x and hash(y) == hash(x) and repr(y) == "datetime." + repr(x).split(".", 1)[-1], (x, y)
            class Mine(datetime.datetime):
                pass
            assert not isinstance(now, Mine) and type(Mine.now()) is Mine and repr(Mine.now()) == "Mine(2025, 1, 1, 0, 0)"
            """
        )

    def test_a_program_cannot_set_the_clock_or_pin_itself(self):
        self.program(
            """
            for name in "clock_settime", "clock_settime_ns":
                try:
                    getattr(time, name, getattr(time, "clock_settime"))(time.CLOCK_REALTIME, 0)
                except PermissionError:
                    continue
                raise AssertionError("set")
            if hasattr(os, "sched_setaffinity"):
                os.sched_setaffinity(0, os.sched_getaffinity(0))
                try:
                    os.sched_setaffinity(0, {1})
                except OSError:
                    pass
                else:
                    raise AssertionError("there is one core")
            """
        )


class Files(Case):
    def test_folders_are_in_order(self):
        self.program(
            """
            import glob, pathlib, shutil
            names = ["n%02d" % (7 * i % 50) for i in range(50)]
            for name in names:
                open(name, "w").close()
            os.makedirs("z/y")
            names.append("program.py")
            everything = sorted(names + ["z"])
            assert os.listdir() == os.listdir(".") == everything and os.listdir(b".") == [n.encode() for n in everything]
            with os.scandir() as found:
                assert next(found).name == everything[0] and [e.name for e in found] == everything[1:]
            found = os.scandir(".")
            entry = next(found)
            found.close()
            assert next(found, None) is None
            assert isinstance(entry, os.DirEntry) and repr(entry) == "<DirEntry 'n00'>" and os.fspath(entry) == "./n00"
            assert entry.is_file() and not entry.is_dir() and not entry.is_symlink() and entry.inode() == entry.stat().st_ino
            assert entry.stat(follow_symlinks=False) == os.lstat("n00") and entry.path == "./n00"
            assert next(os.walk("."))[2] == sorted(names) and next(os.fwalk("."))[2] == sorted(names)
            assert glob.glob("n*") == sorted(names)[:50] and [p.name for p in pathlib.Path().iterdir()] == everything
            assert [p.name for p in pathlib.Path().glob("n*")] == sorted(names)[:50]
            assert [str(p) for p in pathlib.Path().rglob("y")] == ["z/y"]
            shutil.copytree(".", "zz", ignore=shutil.ignore_patterns("zz"))
            assert os.listdir("zz") == everything
            if sys.version_info >= (3, 9):
                os.DirEntry[str]
            """
        )

    def test_changes_are_seen_in_simulated_time(self):
        self.program(
            """
            import pathlib, pickle
            start = 1735689600
            for later in range(20):
                with open("f", "w") as file:
                    file.write("x")
                for _ in range(2):
                    seen = os.stat("f")
                    assert (seen.st_mtime, seen.st_mtime_ns, seen[8]) == (start + later, (start + later) * 10**9, start + later)
                    assert seen.st_ctime == seen.st_atime == os.path.getmtime("f") == pathlib.Path("f").stat().st_mtime
                    time.sleep(0.25)
                with open("f") as file:
                    assert os.fstat(file.fileno()) == os.lstat("f") == seen == pickle.loads(pickle.dumps(seen))
                with os.scandir() as found:
                    assert next(found).stat() == seen
                time.sleep(0.5)
            assert isinstance(seen, os.stat_result) and len(seen) == 10 and seen.st_size == 1 and seen.st_blksize
            os.utime("f", (5, 7))
            assert os.stat("f").st_mtime == 7 and os.stat("f").st_ctime == start + 20
            os.utime("f", (2e9, 2e9))
            assert os.stat("f").st_mtime == 2e9
            """
        )

    def test_on_older_kernels_no_request_passes_within_a_tick_of_the_file_clock(self):
        times, slept = files._Times(lambda: 5 * 10**9), []
        with tempfile.NamedTemporaryFile() as file:
            tick = os.fstat(file.fileno()).st_mtime_ns
            times._start, times._clock, times._sleep = tick, lambda: tick + (len(slept) > 2), slept.append
            times.settle()
            self.assertEqual(slept, [], "nothing was seen")
            self.assertEqual(times.shown(os.stat(file.name)).st_mtime, 5)
            times.settle()
            self.assertEqual(len(slept), 3)

    def test_older_files_keep_their_times(self):
        here = os.path.abspath(__file__)
        text = "x = os.stat(%r)\nprint(x.st_mtime_ns, x.st_mtime, x[8], x.st_ctime_ns)" % here
        real = os.stat(here)
        expected = "%s %s %s %s\n" % (real.st_mtime_ns, real.st_mtime, real[8], real.st_ctime_ns)
        self.assertEqual(self.program(text), expected)


if __name__ == "__main__":
    unittest.main()
