"""How coverage gets to the harness, and the analyses made beforehand."""

import json
import os
import subprocess
import sys
import tempfile
import unittest

from harness import ROOT, run

COVER = os.path.join(ROOT, "hrdsl", "cover.py")
PACKAGE = os.environ.get("HRDSL_COVERAGE_PACKAGE", "")


def is_installed():
    sys.path.append(PACKAGE)
    try:
        import coverage  # noqa: F401
    except ImportError:
        return False
    return True


@unittest.skipUnless(is_installed(), "coverage.py is not installed")
class Coverage(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def file(self, name, text):
        path = os.path.join(self.folder, name)
        with open(path, "w") as file:
            file.write(text)
        return path

    def analyse(self, *files, by_path=False, **env):
        start = ["-S", COVER] if by_path else ["-m", "hrdsl.cover"]
        given = dict(os.environ, PYTHONPATH=ROOT, HRDSL_COVERAGE_CACHE=self.folder, **env)
        given["PYTHONPATH"] = os.pathsep.join([ROOT, *filter(None, sys.path)])
        given["HRDSL_COVERAGE_PACKAGE"] = PACKAGE
        command = [sys.executable, *start, "--analyse", *files]
        done = subprocess.run(command, env=given, stderr=subprocess.PIPE, universal_newlines=True)
        return done.returncode, done.stderr

    def kept(self):
        return sorted(name for name in os.listdir(self.folder) if name.endswith(".json"))

    def test_it_goes_to_a_descriptor_that_is_not_handed_on(self):
        text = "import os, posix, subprocess, sys\nif posix.fork():\n    os.wait()\nelse:\n    sys.exit(0)\n"
        text += "subprocess.run([sys.executable, '-c', 'import os; os.fstat(%s)' % sys.argv[1]], close_fds=False)\n"
        script = self.file("script.py", text)
        with tempfile.TemporaryFile() as out:
            env = {"HRDSL_COVERAGE_PACKAGE": PACKAGE, "HRDSL_COVERAGE_CACHE": self.folder}
            env["HRDSL_COVERAGE_FD"] = str(out.fileno())
            options = ["--coverage", script]
            finished = run([script, str(out.fileno())], options=options, keep=[out.fileno()], env=env)
            self.assertEqual(finished.code, 0, finished.err)
            self.assertIn("Bad file descriptor", finished.err)
            out.seek(0)
            found = json.load(out)[script]  # the forked process wrote none
        self.assertEqual((found["statements"], found["executed"]), ([1, 2, 3, 5, 6], [1, 2, 3, 6]))

    def test_a_descriptor_that_is_none_is_refused(self):
        for value in ("987", "x"):
            finished = run(["no.py"], env={"HRDSL_COVERAGE_FD": value})
            self.assertEqual(finished.code, 2)
            self.assertTrue(finished.err.startswith("hrdsl: HRDSL_COVERAGE_FD is %s, which is no open descriptor\nusage: " % value))

    def test_analyses_are_made_beforehand(self):
        script = self.file("script.py", "import sys\nif len(sys.argv) > 9:\n    x = 1\n")
        self.assertEqual(self.analyse(script), (0, ""))
        before = self.kept()
        self.assertEqual(len(before), 1)
        self.assertEqual(self.analyse(script, by_path=True), (0, ""))
        env = {"HRDSL_COVERAGE_PACKAGE": PACKAGE, "HRDSL_COVERAGE_CACHE": self.folder}
        with tempfile.TemporaryFile() as out:
            env["HRDSL_COVERAGE_FD"] = str(out.fileno())
            finished = run([script], options=["--coverage", script], keep=[out.fileno()], env=env)
            self.assertEqual((finished.code, finished.err, self.kept()), (0, "", before), "the run found it")
            out.seek(0)
            self.assertEqual(json.load(out)[script]["executed_branches"], [[2, -1]])

    def test_a_file_that_cannot_be_analysed_is_named(self):
        good = self.file("good.py", "x = 1\n")
        bad = self.file("bad.py", "x = 1\ny = = 2\n")
        lost = os.path.join(self.folder, "lost.py")
        code, said = self.analyse(bad, lost, good)
        self.assertEqual((code, len(self.kept())), (1, 1))
        first, second = said.splitlines()
        self.assertTrue(first.startswith("hrdsl: no coverage of %s: line 2: " % bad), first)
        self.assertEqual(second, "hrdsl: no coverage of %s: No such file or directory" % lost)

    def test_a_cache_that_cannot_be_written_is_named(self):
        good = self.file("good.py", "x = 1\n")
        code, said = self.analyse("--cache", os.path.join(self.folder, "lost"), good)
        self.assertEqual(code, 1)
        self.assertRegex(said, r"^hrdsl: no coverage of .*good.py: No such file or directory: .*/lost/.*\n$")

    def test_a_wrong_command_line_is_refused(self):
        for words in ([], ["--cache", "x"], ["--package"]):
            code, said = self.analyse(*words)
            self.assertEqual((code, said.split()[0]), (2, "usage:"))


if __name__ == "__main__":
    unittest.main()
