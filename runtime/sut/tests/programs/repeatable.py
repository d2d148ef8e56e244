"""Reads every source that spec/randomness.md calls repeatable: a line for each row of its table."""

import datetime
import os
import random
import secrets
import ssl
import tempfile
import threading
import time
import uuid

import hrdsl


def generators():
    import _random

    again = random.Random(1)
    again.seed()
    return random.Random().random(), random.Random(None).random(), again.random(), _random.Random().random()


def entropy():
    got = [os.urandom(4), random.SystemRandom().random(), secrets.token_hex(4), secrets.randbelow(10**9)]
    return got + [os.getrandom(4)] if hasattr(os, "getrandom") else got


def openssl():
    return [getattr(ssl, name)(4) for name in ("RAND_bytes", "RAND_pseudo_bytes") if hasattr(ssl, name)]


def numpy():
    try:
        import numpy.random
    except ImportError:
        return secrets.randbits(128)  # from which it takes its seeds
    numpy.random.seed()
    return numpy.random.default_rng().random(), numpy.random.RandomState().rand(), numpy.random.rand()


def uuids():
    return [getattr(uuid, name)() for name in ("uuid1", "uuid4", "uuid6", "uuid7", "uuid8") if hasattr(uuid, name)]


def temporary():
    with tempfile.NamedTemporaryFile() as file, tempfile.TemporaryDirectory() as folder:
        return file.name, folder


def time_of_day():
    return time.time(), time.time_ns(), time.ctime(), time.gmtime(), time.strftime("%c %Z"), time.clock_gettime(0)


def dates():
    date, utc = datetime.datetime, datetime.timezone.utc
    return date.now(), date.now(utc), date.today(), datetime.date.today(), date.now(utc).astimezone()


def elapsed():
    return time.monotonic(), time.monotonic_ns(), time.perf_counter(), time.perf_counter_ns(), time.clock_gettime(1)


def computing():
    import resource

    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return time.process_time(), time.process_time_ns(), time.thread_time(), os.times(), used


def clocks():
    names = ("time", "monotonic", "perf_counter", "process_time", "thread_time")
    return time.clock_getres(time.CLOCK_MONOTONIC), [time.get_clock_info(name) for name in names]


def changes():
    with tempfile.NamedTemporaryFile() as file:
        seen = [os.stat(file.name), os.lstat(file.name), os.fstat(file.fileno())]
        hrdsl.Node("repeatable").sleep(0.5)
        file.write(b"text")
        file.flush()
        with os.scandir(os.path.dirname(file.name)) as found:
            seen += [entry.stat() for entry in found if entry.path == file.name]
        return [(one.st_mtime_ns, one.st_ctime, one.st_atime, one.st_size) for one in seen]


def order():
    with tempfile.TemporaryDirectory() as folder:
        for number in range(30):
            open(os.path.join(folder, str(number * 7 % 30)), "w").close()
        entries = [entry.name for entry in os.scandir(folder)]
        return os.listdir(folder), entries, [files for _, _, files in os.walk(folder)]


def cores():
    import multiprocessing

    counts = [os.cpu_count(), multiprocessing.cpu_count(), os.sysconf("SC_NPROCESSORS_ONLN"), os.getloadavg()]
    counts += [getattr(os, name)() for name in ("process_cpu_count",) if hasattr(os, name)]
    return counts + [os.sched_getaffinity(0) if hasattr(os, "sched_getaffinity") else None]


def threads():
    seen = [threading.get_native_id()]
    for _ in range(3):
        thread = threading.Thread(target=lambda: seen.append(threading.get_native_id()))
        thread.start()
        thread.join()
    return seen


def waits():
    import asyncio
    import queue
    import select

    seen = []
    for wait in (
        lambda: threading.Event().wait(0.5),
        lambda: threading.Semaphore(0).acquire(timeout=0.25),
        lambda: select.select([], [], [], 1.5),
        lambda: asyncio.run(asyncio.sleep(2)),
        lambda: queue.Queue().get(timeout=0.75),
    ):
        try:
            wait()
        except queue.Empty:
            pass
        seen.append(time.monotonic())
    return seen


def order_of_threads():
    import concurrent.futures

    seen, lock = [], threading.Lock()

    def work(number):
        for _ in range(3):
            time.sleep(0.1)
            with lock:
                seen.append(number)

    started = [threading.Thread(target=work, args=(number,)) for number in range(5)]
    for thread in started:
        thread.start()
    with concurrent.futures.ThreadPoolExecutor(3) as pool:
        pool.map(work, range(5, 10))
    for thread in started:
        thread.join()
    return seen


def order_of_tasks():
    import asyncio

    order = []

    async def step(number):
        order.append(number)
        await asyncio.sleep(number % 2)
        order.append(number)

    async def main():
        await asyncio.gather(*[step(number) for number in range(6)])

    asyncio.run(main())
    return order


ROWS = {
    "the module `random`": lambda: (random.random(), random.seed(), random.random(), random.gauss(0, 1)),
    "generators without a seed": generators,
    "entropy of the system": entropy,
    "entropy of OpenSSL": openssl,
    "generators of NumPy": numpy,
    "universally unique identifiers": uuids,
    "address of the network card": uuid.getnode,
    "names of temporary files": temporary,
    "hashes of texts, and the order of sets": lambda: (hash("text"), hash(b"bytes"), {"x", "y", "z", "w", "v", "u", "t"}),
    "time of day": time_of_day,
    "dates": dates,
    "time elapsed": elapsed,
    "time spent computing": computing,
    "what clocks say of themselves": clocks,
    "when files were changed": changes,
    "order of the files in a folder": order,
    "cores and load": cores,
    "numbers of threads": threads,
    "waits": waits,
    "the order in which threads run": order_of_threads,
    "the order in which tasks go on": order_of_tasks,
}

hrdsl.Node("repeatable").sleep(90.25)
for name, row in ROWS.items():
    print("%s: %s" % (name, row()))
