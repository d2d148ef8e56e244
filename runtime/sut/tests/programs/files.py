"""Writes where programs write, and says what it finds there."""
import os
import pathlib
import sys
import tempfile

import hrdsl

node = hrdsl.Node("files")
found = []
for path in ["log.txt", "~/state.txt", tempfile.gettempdir() + "/cache.txt", sys.argv[1]]:
    path = pathlib.Path(path).expanduser()
    with open(path, "a") as file:
        file.write("a line\n")
    found.append(len(path.read_text().splitlines()))
with open("hello.py", "a") as file:
    file.write("# changed\n")
os.remove("good.py")
print(found, os.getcwd(), os.path.expanduser("~"), tempfile.gettempdir())
print(os.getpid(), os.path.exists("good.py"), os.path.exists("hidden"))
