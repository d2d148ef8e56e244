"""Prints everything that could differ between two runs."""

import datetime
import os
import random
import secrets
import time
import uuid

import hrdsl

print(random.random(), random.SystemRandom().random(), secrets.token_hex(4), uuid.uuid4(), os.urandom(3))
print([hash(word) for word in ("a", "b", b"c")], list({"x", "y", "z", "w"}))
print(time.time(), time.time_ns(), time.monotonic(), time.perf_counter_ns(), time.ctime(), time.strftime("%H:%M:%S"))
print(datetime.datetime.now(), datetime.datetime.now(datetime.timezone.utc), datetime.date.today())
print(isinstance(datetime.datetime.strptime("2020", "%Y"), datetime.datetime), datetime.datetime.now().tzinfo)
time.sleep(90.25)
print(time.time(), time.monotonic(), time.process_time(), time.ctime())
print(datetime.datetime.now() - datetime.timedelta(seconds=1), type(datetime.datetime.now()))
hrdsl.Node("chance").sleep(1)
print(time.monotonic(), exit, quit)
