"""Type checkers know the types of the whole package, and its users do not pay for that."""

import importlib
import inspect
import os
import subprocess
import sys
import unittest

from harness import ROOT

sys.path.insert(0, ROOT)


class Types(unittest.TestCase):
    def test_everything_is_annotated(self):
        names = sorted(name[:-3] for name in os.listdir(os.path.join(ROOT, "hrdsl")) if name.endswith(".py"))
        for name in names:
            module = importlib.import_module("hrdsl." + name)
            classes = [kind for _, kind in inspect.getmembers(module, inspect.isclass) if kind.__module__ == module.__name__]
            for place in [module, *classes]:
                for _, function in inspect.getmembers(place, inspect.isfunction):
                    if function.__module__ == module.__name__:
                        self.check(function)

    def check(self, function):
        signature = inspect.signature(function)
        untyped = [name for name, one in signature.parameters.items() if one.annotation is one.empty]
        self.assertIn(untyped, ([], ["self"], ["cls"]), function)
        self.assertIsNot(signature.return_annotation, signature.empty, function)

    def test_checkers_are_told(self):
        self.assertTrue(os.path.exists(os.path.join(ROOT, "hrdsl", "py.typed")))

    def test_importing_it_does_not_import_typing(self):
        text = "import sys; sys.path.append(%r); import hrdsl.runner; print('typing' in sys.modules)" % ROOT
        done = subprocess.run([sys.executable, "-S", "-c", text], stdout=subprocess.PIPE, universal_newlines=True)
        self.assertEqual(done.stdout, "False\n")


if __name__ == "__main__":
    unittest.main()
