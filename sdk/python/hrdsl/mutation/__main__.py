"""`python -m hrdsl.mutation list FILE…`, `… codes FILE --to DIR NUMBER…` and `… run FILE NUMBER -- PROGRAM ARGS…`."""

from __future__ import annotations

import argparse
import json
import sys

if not __package__:  # started by its path, from a folder whose modules may have any names
    sys.path[0] = __file__.rpartition("hrdsl/mutation")[0] or "."

from hrdsl.mutation.found import UnknownOperator, check_operators, operators
from hrdsl.mutation.kept import rows
from hrdsl.mutation.switch import codes, switched

_EXAMPLES = """examples:
  python -m hrdsl.mutation list robot.py
  python -m hrdsl.mutation list robot.py fsm.py --operator time deadline --json
  python -m hrdsl.mutation run robot.py 17 -- robot.py --legs 2

operators: %s

exit codes: 0 done, 2 a wrong option or a file that cannot be read or compiled"""


def main(args: list[str]) -> int:
    parser = argparse.ArgumentParser(
        "python -m hrdsl.mutation",
        description="Small faults in robot code, one at a time and in memory only.",
        epilog=_EXAMPLES % ", ".join(operators()),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    commands = parser.add_subparsers(dest="command", required=True)
    listing = commands.add_parser("list", help="list the mutants of files")
    listing.add_argument("files", nargs="+", metavar="FILE")
    listing.add_argument("--operator", nargs="+", default=[], metavar="NAME", help="only these operators")
    listing.add_argument("--json", action="store_true", help="print JSON")
    listing.add_argument("--cache", metavar="DIR", help="keep lists in this folder, and use those that are there")
    compiling = commands.add_parser("codes", help="compile mutants, each to NUMBER.code in a folder")
    compiling.add_argument("file", metavar="FILE")
    compiling.add_argument("--to", required=True, metavar="DIR", help="the folder, which is there")
    compiling.add_argument("numbers", nargs="+", type=int, metavar="NUMBER")
    running = commands.add_parser("run", help="run a program with one mutant")
    running.add_argument("file", metavar="FILE", help="the file that the mutant changes")
    running.add_argument("number", type=int, metavar="NUMBER", help="of the mutant, as `list` shows it")
    running.add_argument("program", nargs="+", metavar="PROGRAM", help="the program, and its arguments")
    given = parser.parse_args(args)
    try:
        if given.command == "list":
            return _list(given.files, given.operator, given.json, given.cache)
        if given.command == "codes":
            codes(given.file, given.numbers, given.to)
            return 0
        run = switched(given.file, given.number, given.program)
    except SyntaxError as error:
        problem = "%s:%s: %s; correct it first" % (error.filename, error.lineno, error.msg)
    except (OSError, UnicodeDecodeError, UnknownOperator, LookupError) as error:
        problem = str(error.args[0] if isinstance(error, LookupError) else error)
    else:
        run()
        return 0
    print("error: " + problem, file=sys.stderr)
    return 2


def _list(files: list[str], only: list[str], as_json: bool, cache: str | None) -> int:
    check_operators(only)
    found = [row for file in files for row in rows(file, cache) if not only or row["operator"] in only]
    if as_json:
        print(json.dumps({"format": "hrdsl-mutants", "version": 1, "mutants": found}, indent=1))
        return 0
    for row in found:
        needless = "  (%s)" % row["needless"] if row["needless"] else ""
        print("%(file)s:%(line)d  %(number)d  %(operator)s: %(what)s" % row + needless)
    worth = sum(not row["needless"] for row in found)
    print("%d mutants, %d of them worth a run" % (len(found), worth))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
