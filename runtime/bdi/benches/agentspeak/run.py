#!/usr/bin/env python3
"""Measures the same agent programs with hrdsl, python-agentspeak and (if its jar is given) Jason.

    run.py [--runs N] [--goals N] [--messages N] [--depth N] [--agents N] [--each N]
           [--ours FILE | --no-ours] [--no-agentspeak] [--jason JAR]

Prints a Markdown table. `README.md` says what is measured.
"""

import argparse
import io
import json
import os
import re
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[3]
VENV = ROOT / "target" / "agentspeak"
PACKAGE = "agentspeak==0.2.2"

# What is measured: its programs, the project file for Jason, the benchmark of ours, and the unit of its rate.
PROGRAMS = {
    "goals": (["counter.asl"], "counter.mas2j", "goals", "goals/s"),
    "messages": (["ping.asl", "pong.asl"], "ping.mas2j", "messages", "messages/s"),
    "crowd": (["crowd.asl"], "crowd.mas2j", "crowd", "goals/s"),
    "deep": (["deep.asl"], "deep.mas2j", "deep 100000", "goals/s"),
}
# A measurement is not repeated once its runs have taken so many seconds.
ENOUGH = 20.0
# Jason is stopped when it has not finished after so many seconds.
PATIENCE = 600.0


def with_number(source, number):
    """The program with another number in its initial goal."""
    return re.sub(r"^(!\w+\()\d+", lambda goal: f"{goal[1]}{number}", source, flags=re.MULTILINE)


# hrdsl


def parse_divan(text):
    """The medians in divan's table: by name (`deep 10000` in a group), seconds and items a second."""
    seconds = {"ns": 1e-9, "µs": 1e-6, "ms": 1e-3, "s": 1.0}
    factors = {"": 1.0, "K": 1e3, "M": 1e6, "G": 1e9}
    found, group, last = {}, "", None
    for line in text.splitlines():
        row = re.match(r"(│?\s*)[├╰]─ (\S+)", line)
        times = re.findall(r"([\d.]+) (ns|µs|ms|s)\s", line)
        rates = re.findall(r"([\d.]+) ([KMG]?)item/s", line)
        if row and len(times) == 4:
            last = f"{group} {row[2]}" if row[1] else row[2]
            found[last] = {"wall": float(times[2][0]) * seconds[times[2][1]]}
        elif row:
            group = row[2]
        elif last and len(rates) == 4:
            found[last]["rate"] = float(rates[2][0]) * factors[rates[2][1]]
    return {name: row for name, row in found.items() if "rate" in row}


def bench_binary():
    """Builds our benchmark; the path of its binary."""
    command = ["cargo", "bench", "-p", "hrdsl-bdi", "--bench", "engine", "--no-run", "--message-format=json"]
    built = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True)
    messages = [json.loads(line) for line in built.stdout.splitlines() if line.startswith("{")]
    return next(m["executable"] for m in messages if m.get("executable") and m["target"]["name"] == "engine")


def peak_of(command):
    """The peak memory of a command, in bytes, or nothing where there is no `/proc`.

    Sampled: `ru_maxrss` of a small child is that of this script, from which it was forked. Each sample of the
    benchmark does the same again, so the last look misses nothing.
    """
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    peak = None
    while process.poll() is None:
        try:
            # The first look may come before the new program has replaced the copy of this one.
            if os.readlink(f"/proc/{process.pid}/exe") == os.path.realpath(command[0]):
                status = Path(f"/proc/{process.pid}/status").read_text(encoding="utf-8")
                peak = int(re.search(r"VmHWM:\s*(\d+) kB", status)[1]) * 1024
        except (OSError, TypeError):
            pass
        time.sleep(0.005)
    if process.returncode != 0:
        sys.exit(f"`{' '.join(command)}` ended with {process.returncode}")
    return peak


def ours(file):
    """Our figures: from a file with the output of `cargo bench`, or measured."""
    if file:
        text, binary = Path(file).read_text(encoding="utf-8"), None
    else:
        command = ["cargo", "bench", "-p", "hrdsl-bdi", "--bench", "engine"]
        text = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout
        binary = bench_binary()
    rows, results = parse_divan(text), {}
    for measure, (_, _, name, _) in PROGRAMS.items():
        if name not in rows:
            sys.exit(f"no benchmark `{name}` in the output of `cargo bench`")
        row = rows[name]
        # Divan prints four digits of both, so their product is the size but for rounding.
        results[measure] = {**row, "size": float(f"{row['wall'] * row['rate']:.2g}")}
        if binary:
            path = "engine::" + name.replace(" ", "::")
            peak = peak_of([binary, "--bench", "--exact", path])
            results[measure].update({"peak": peak} if peak else {})
    return results


# python-agentspeak


def child(files, agents, number):
    """Runs one program with python-agentspeak, in a process of its own; prints the figures as JSON."""
    import resource

    import agentspeak
    import agentspeak.runtime
    import agentspeak.stdlib

    actions = agentspeak.Actions(agentspeak.stdlib.actions)
    done = 0

    @actions.add(".print", 1)
    def _print(_agent, _term, _intention):
        nonlocal done
        done += 1
        yield

    sources = []
    for file in files:
        source = io.StringIO(with_number((HERE / file).read_text(encoding="utf-8"), number))
        source.name = file
        sources.append(source)
    before, start = resource.getrusage(resource.RUSAGE_SELF), time.perf_counter()
    env = agentspeak.runtime.Environment()
    for source in sources:
        env.build_agents(source, agents, actions)
    env.run()
    wall, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_SELF)
    if done != agents:
        sys.exit(f"{done} of {agents} agents finished")
    user = after.ru_utime - before.ru_utime
    print(json.dumps({"wall": wall, "user": user, "peak": after.ru_maxrss * 1024}))


def repeated(runs, run):
    """The medians of some runs; fewer if they take long."""
    rows = []
    while len(rows) < runs and sum(row["wall"] for row in rows) < ENOUGH:
        rows.append(run())
    return {key: statistics.median(row[key] for row in rows) for key in rows[0]}


def python_agentspeak(sizes, runs):
    """The figures of python-agentspeak, which is installed into `target/agentspeak`."""
    python = VENV / "bin" / "python"
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", VENV], check=True)
    subprocess.run([python, "-m", "pip", "install", "--quiet", PACKAGE], check=True)
    results = {}
    for measure, (files, _, _, _) in PROGRAMS.items():
        agents, number = sizes[measure]
        command = [python, __file__, "--child", ",".join(files), str(agents), str(number)]

        def run(command=command):
            out = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            if out.returncode != 0:
                raise RuntimeError((out.stderr.strip() or f"ended with {out.returncode}").splitlines()[-1])
            return json.loads(out.stdout)

        try:
            results[measure] = {**repeated(runs, run), "size": agents * number}
        except RuntimeError as error:
            results[measure] = {"failed": str(error), "size": agents * number}
        print(f"python-agentspeak, {measure}: {results[measure]}", file=sys.stderr)
    return results


# Jason

LOGGING = """handlers = java.util.logging.ConsoleHandler
.level = INFO
java.util.logging.ConsoleHandler.level = INFO
java.util.logging.ConsoleHandler.formatter = jason.runtime.MASConsoleLogFormatter
"""


def jason_run(jar, project, files, agents, number, dones):
    """Runs one project with Jason until its agents have said `done`; the figures, its start included."""
    with tempfile.TemporaryDirectory() as folder:
        for file in files:
            source = (HERE / file).read_text(encoding="utf-8")
            (Path(folder) / file).write_text(with_number(source, number), encoding="utf-8")
        source = (HERE / project).read_text(encoding="utf-8")
        (Path(folder) / project).write_text(re.sub(r"#\d+", f"#{agents}", source), encoding="utf-8")
        (Path(folder) / "logging.properties").write_text(LOGGING, encoding="utf-8")
        command = ["java", "-Djava.awt.headless=true", "-cp", jar, "jason.infra.local.RunLocalMAS", project]
        command += ["--no-net", "--log-conf", "logging.properties"]
        start = time.perf_counter()
        process = subprocess.Popen(
            command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True
        )
        # A project does not end by itself.
        clock = threading.Timer(PATIENCE, os.killpg, (process.pid, signal.SIGKILL))
        clock.start()
        missing, tail = dones, ""
        for line in process.stdout:
            tail = line.strip() or tail
            missing -= bool(re.search(r"\bdone\b", line))
            if missing == 0:
                break
        wall = time.perf_counter() - start
        clock.cancel()
        if missing == 0:
            os.killpg(process.pid, signal.SIGKILL)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        process.stdout.close()
        if missing != 0:
            raise RuntimeError(f"ended with {process.returncode}: {tail}")
        return {"wall": wall, "user": usage.ru_utime, "peak": usage.ru_maxrss * 1024}


def jason(jar, sizes, runs):
    """The figures of Jason; the time that an empty project takes to start is subtracted."""
    jar, results = os.pathsep.join(str(Path(part).resolve()) for part in jar.split(os.pathsep)), {}
    if not shutil.which("java"):
        sys.exit("`--jason` needs `java`, which is not there")
    idle = repeated(runs, lambda: jason_run(jar, "counter.mas2j", ["counter.asl"], 1, 0, 1))
    for measure, (files, project, _, _) in PROGRAMS.items():
        agents, number = sizes[measure]

        def run(project=project, files=files, agents=agents, number=number):
            row = jason_run(jar, project, files, agents, number, agents)
            return {**row, "wall": row["wall"] - idle["wall"], "user": row["user"] - idle["user"]}

        try:
            results[measure] = {**repeated(runs, run), "size": agents * number}
        except RuntimeError as error:
            results[measure] = {"failed": str(error), "size": agents * number}
        print(f"Jason, {measure}: {results[measure]}", file=sys.stderr)
    return results


# The table


def number(value):
    """Three digits, with spaces between the thousands."""
    rounded = float(f"{value:.3g}")
    return f"{rounded:,.0f}".replace(",", " ") if abs(rounded) >= 100 else f"{rounded:g}"


def cells(result, unit, reference):
    """The cells of one row, from the size on."""
    size = number(result["size"])
    if "failed" in result:
        return [size, f"failed: {result['failed']}", "–", "–", "–", "–"]
    rate = result.get("rate", result["size"] / result["wall"])
    user = f"{number(result['user'])} s" if "user" in result else "–"
    peak = f"{number(result['peak'] / 2**20)} MiB" if "peak" in result else "–"
    times = f"{number(reference / rate)} ×" if reference else "–"
    return [size, f"{number(result['wall'])} s", f"{number(rate)} {unit}", user, peak, times]


def table(engines):
    """The Markdown table: for each program a row an interpreter."""
    head = ["Program", "Interpreter", "Items", "Wall time", "Rate", "User CPU time", "Peak memory", "hrdsl is faster"]
    lines = [head, ["---"] * 2 + ["---:"] * 6]
    for measure, (_, _, _, unit) in PROGRAMS.items():
        reference = engines.get("hrdsl", {}).get(measure, {}).get("rate")
        for engine, results in engines.items():
            others = None if engine == "hrdsl" else reference
            lines.append([measure, engine, *cells(results[measure], unit, others)])
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def arguments():
    parser = argparse.ArgumentParser(description="Measures the same agent programs with several interpreters.")
    parser.add_argument("--runs", type=int, default=3, help="runs of each program, of which the median counts")
    parser.add_argument("--goals", type=int, default=100_000)
    parser.add_argument("--messages", type=int, default=100_000)
    parser.add_argument("--depth", type=int, default=100_000)
    parser.add_argument("--agents", type=int, default=1000, help="agents of the crowd")
    parser.add_argument("--each", type=int, default=1000, help="goals of each agent of the crowd")
    parser.add_argument("--ours", metavar="FILE", help="the output of `cargo bench -p hrdsl-bdi --bench engine`")
    parser.add_argument("--no-ours", action="store_true")
    parser.add_argument("--no-agentspeak", action="store_true")
    parser.add_argument("--jason", metavar="JAR", help="Jason's jar, or a class path with its libraries")
    options = parser.parse_args()
    if min(options.runs, options.goals, options.messages, options.depth, options.agents, options.each) < 1:
        parser.error("the numbers are at least 1")
    return options


def main():
    if sys.argv[1:2] == ["--child"]:
        files, agents, size = sys.argv[2:5]
        child(files.split(","), int(agents), int(size))
        return
    options = arguments()
    sizes = {
        "goals": (1, options.goals),
        "messages": (1, options.messages),
        "crowd": (options.agents, options.each),
        "deep": (1, options.depth),
    }
    engines = {}
    if not options.no_ours:
        engines["hrdsl"] = ours(options.ours)
    if not options.no_agentspeak:
        engines["python-agentspeak"] = python_agentspeak(sizes, options.runs)
    if options.jason:
        engines["Jason"] = jason(options.jason, sizes, options.runs)
    print(table(engines))
    print(f"\n{os.cpu_count()} cores, load average {os.getloadavg()[0]:.1f}.")


if __name__ == "__main__":
    main()
