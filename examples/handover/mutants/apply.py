#!/usr/bin/env python3
"""Makes copies of the example in which the robot has one of the faults of this folder.

    python3 mutants/apply.py NAME DEST     DEST is the copy
    python3 mutants/apply.py --all DEST    DEST has a folder for each fault, of the same name

Before it makes any, it applies all patches, and says which do not fit the robot's code as it is, do not compile, or give the same
bytecode as the original or as each other; line numbers, comments and docstrings do not count. The exit code is 1 then.
"""

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import types

MUTANTS = os.path.dirname(os.path.realpath(__file__))
EXAMPLE = os.path.dirname(MUTANTS)
CODE = ("robot.py", "fsm.py")


class PatchError(Exception):
    """A patch does not do what it should."""


def names():
    """Those of all faults."""
    return sorted(file[: -len(".patch")] for file in os.listdir(MUTANTS) if file.endswith(".patch"))


def patch(folder, name):
    """Applies a patch to the code in a folder. Lines around it must be as they are in the patch."""
    # In a folder that is taken for no part of a repository, whatever lies above it.
    environment = dict(os.environ, GIT_CEILING_DIRECTORIES=os.path.dirname(os.path.realpath(folder)))
    command = ["git", "apply", "--whitespace=nowarn", os.path.join(MUTANTS, name + ".patch")]
    done = subprocess.run(command, cwd=folder, env=environment, stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode:
        raise PatchError("%s does not fit: %s" % (name, done.stderr.strip()))


def essence(code):
    """What a code object does, without where it stands in the file."""
    constants = [essence(c) if isinstance(c, types.CodeType) else repr(c) for c in code.co_consts]
    names_used = (code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars)
    arguments = (code.co_argcount, code.co_posonlyargcount, code.co_kwonlyargcount, code.co_flags)
    return (code.co_name, code.co_code, tuple(constants), names_used, arguments, getattr(code, "co_exceptiontable", b""))


def bytecode(folder):
    """That of the robot's code in a folder."""
    essences = []
    for file in CODE:
        path = os.path.join(folder, file)
        with open(path, encoding="utf-8") as source:
            essences.append(essence(compile(source.read(), path, "exec", dont_inherit=True, optimize=2)))
    return tuple(essences)


def faults():
    """What is wrong with the patches, a line each."""
    found = []
    known = {bytecode(EXAMPLE): "the original"}
    for name in names():
        with tempfile.TemporaryDirectory() as folder:
            for file in CODE:
                shutil.copy(os.path.join(EXAMPLE, file), folder)
            try:
                patch(folder, name)
                code = bytecode(folder)
            except (PatchError, SyntaxError) as error:
                found.append("%s: %s" % (name, error))
                continue
        if code in known:
            found.append("%s does the same as %s" % (name, known[code]))
        known.setdefault(code, name)
    return found


def make(name, to):
    """Copies the example, without its faults and what was made by running it, and gives it one of them."""
    own = shutil.ignore_patterns("__pycache__", "hrdsl-out", os.path.basename(MUTANTS))
    shutil.copytree(EXAMPLE, to, ignore=own)
    patch(to, name)


def main():
    parser = argparse.ArgumentParser(description="Makes copies of the example in which the robot has a fault.")
    parser.add_argument("name", nargs="?", help="the fault: the name of a patch, without its end")
    parser.add_argument("dest", help="the folder to make")
    parser.add_argument("--all", action="store_true", help="one copy for each fault, in folders of their names")
    options = parser.parse_args()
    if options.all == bool(options.name):
        parser.error("either the name of a fault, or --all")
    name = os.path.basename(options.name or "").removesuffix(".patch")
    if not options.all and name not in names():
        parser.error("there is no fault of the name %s; there are: %s" % (name, ", ".join(names())))
    if os.path.exists(options.dest):
        parser.error("%s is there already" % options.dest)
    # A copy of a folder into itself would have no end.
    if os.path.commonpath([EXAMPLE, os.path.realpath(options.dest)]) == EXAMPLE:
        parser.error("%s is in the example's own folder" % options.dest)
    found = faults()
    if found:
        print("\n".join(found), file=sys.stderr)
        return 1
    if not options.all:
        make(name, options.dest)
        return 0
    os.makedirs(options.dest)
    for each in names():
        make(each, os.path.join(options.dest, each))
    print("%d copies of the example, each with a fault of its own" % len(names()))
    return 0


if __name__ == "__main__":
    sys.exit(main())
