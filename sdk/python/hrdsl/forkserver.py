"""Forks the runs of a program: a process that has imported what the program will, waits for tests, and makes a run of each.

It runs in a cell of its own, which can write nowhere. For each test

1. it forks the first process of new namespaces, which waits for an order: so nothing of any test is ever seen by a later one;
2. that process forks the program, and becomes the supervisor of the cell (`runtime/sut/src/cell/supervisor.rs`);
3. the program waits until the cell is ready, gives up its rights, and begins.

The server forks for the next test as soon as an order was taken.

HRDSL_FORK_SERVER is the descriptor of a socket of packets. The server writes one when it is ready: `{"modules": [...]}`. An
order is one packet, `{"seed": N}` and perhaps which mutant is run (`"mutant"`, see `hrdsl.mutated`), with the descriptors of the supervisor's connection, standard output, standard error,
requests, replies, and coverage if it is measured. HRDSL_FORK_CELL is what the cell says of itself, and HRDSL_FORK_MODULES which
modules are imported beforehand: both are JSON. HRDSL_FORK_BINDS is there if LD_BIND_NOW is the server's alone.
"""

from __future__ import annotations

import _socket
import ctypes
import gc
import json
import os
import posix

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, NoReturn

    from hrdsl.link import Link
    from hrdsl.runner import PreparedRun

#: The program's descriptors, after those of the standard streams: the same numbers in every run.
_REQUESTS, _REPLIES, _COVERAGE = 3, 4, 5

#: Higher than any descriptor of the server's.
_HIGH = 64

#: What the runner itself imports while programs run, so that none of them has to.
_OWN = ("_heapq", "_random", "hrdsl.mutated")

# linux/sched.h
_NEW_PROCESSES = 0x20000000

# linux/prctl.h, linux/capability.h
_CAPBSET_DROP, _CAP_AMBIENT, _CLEAR_ALL = 24, 47, 4
_CAPABILITY_VERSION = 0x20080522


def serve(run: PreparedRun) -> tuple[int | None, int]:
    """Serves orders; returns in each program's process, with the descriptor for its coverage and the seed."""
    environment = os.environ
    orders = _socket.socket(fileno=int(environment.pop("HRDSL_FORK_SERVER")))
    cell = json.loads(environment.pop("HRDSL_FORK_CELL"))
    cell["folder"] = os.getcwd()  # which a fork cannot tell while its cell is made
    modules = json.loads(environment.pop("HRDSL_FORK_MODULES"))
    if environment.pop("HRDSL_FORK_BINDS", ""):
        del environment["LD_BIND_NOW"]  # which the dynamic linker has read, and the program was not given
    orders.setblocking(True)
    rights = _Rights(cell["beyond"])
    rights.lay_down()
    run.simulation.chance.is_drawn_by_forks = False
    if run.recorder is not None:
        run.recorder.prepare()
    if modules["preload"] is None:
        from hrdsl import preload

        found = preload.find(run, modules["own"])
    else:
        found = modules["preload"]
        for name in found:
            __import__(name)
    for name in _OWN:
        __import__(name)
    run.compile()
    gc.collect()
    gc.freeze()
    orders.send(json.dumps({"modules": found}).encode())
    rights.take_up()
    nursery = _Nursery(rights, cell["namespaces"])
    take = nursery.next()
    while take is None:
        take = nursery.next()
    return _attend(orders, cell, take, nursery, run.link)


class _Nursery:
    """Forks the first processes of cells, one after the other. What it does between two forks makes the same objects every time, and
    keeps none, so that each fork finds the same memory."""

    def __init__(self, rights: _Rights, namespaces: int) -> None:
        self.rights = rights
        self._processes, self._others = namespaces & _NEW_PROCESSES, namespaces & ~_NEW_PROCESSES
        self._own = os.open("/proc/self/ns/pid", os.O_RDONLY | os.O_CLOEXEC)
        self._fork = ctypes.PyDLL(None).fork
        self._fault: OSError | None = None
        for number in ("1000000", "1000001"):  # takes and frees what the numbers of processes take
            (int(number), 0)
        self._reap()
        self._renew()

    def next(self) -> int | None:
        """Forks one, and returns in it: with what it closes when it has its order, to which it writes a byte before. In the server, returns
        None when that has happened."""
        self._renew()
        taken, take = posix.pipe()
        # By the system's call alone: what Python does at forks is for the program's, by which it begins.
        if not self._fork():
            return take
        posix.close(take)
        if not posix.read(taken, 1):
            os._exit(0)  # there are no more orders, or somebody has killed it
        posix.close(taken)
        self._reap()
        return None

    def enter(self) -> None:
        """In the process that was forked: enters the other namespaces of its cell."""
        if self._fault is not None:
            raise self._fault
        self.rights.enter(self._others)

    def _renew(self) -> None:
        """Lets the next fork be the first process of a namespace, instead of one of the last one's, which ends with that."""
        self._fault = None
        if not self._processes:
            return
        try:
            self.rights.leave(self._own)
            self.rights.enter(self._processes)
        except OSError as error:
            self._fault = error

    def _reap(self) -> None:
        while self.rights.libc.waitpid(-1, None, posix.WNOHANG) > 0:
            pass


def _attend(orders: Any, cell: dict[str, Any], take: int, nursery: _Nursery, link: Link) -> tuple[int | None, int]:
    """In the first process of a cell: waits for an order, and forks the program. Returns in the program's process only."""
    rights = nursery.rights
    fault: OSError | None = None
    try:
        nursery.enter()
    except OSError as error:
        fault = error
    try:
        text, ancillary, _, _ = orders.recvmsg(4096, _socket.CMSG_SPACE(8 * 4), _socket.MSG_CMSG_CLOEXEC)
    except OSError:
        text = b""
    if not text:
        os._exit(0)
    posix.write(take, b"+")
    posix.close(take)
    descriptors = [number for _, _, data in ancillary for number in memoryview(data).cast("i")]
    control, given = descriptors[0], descriptors[1:]
    orders.close()
    try:
        if fault is not None:
            raise fault
        os.setsid()
        ready, go = os.pipe()
        program = posix.fork()
        if program:
            _supervise(cell, control, given, program, go)
    except OSError as error:
        _refuse(control, "a fork of the program", error)
    os.close(go)
    _begin(ready, given, cell["folder"], rights)
    link.connect(_REQUESTS, _REPLIES)
    order = json.loads(text)
    seed = order["seed"]
    os.environ["HRDSL_SEED"] = str(seed)
    if "mutant" in order:
        os.environ["HRDSL_MUTANT"] = order["mutant"]
    if len(given) <= _COVERAGE - 1:
        return None, seed
    os.set_inheritable(_COVERAGE, False)
    return _COVERAGE, seed


def _supervise(cell: dict[str, Any], control: int, given: list[int], program: int, go: int) -> NoReturn:
    """The first process of the namespaces becomes the supervisor, whose child the program is."""
    try:
        for place, descriptor in enumerate([control, *given[:2]]):
            os.dup2(descriptor, place)
        os.set_inheritable(go, True)
        os.execve(cell["supervisor"], [*cell["words"], str(program), str(go)], {})
    except OSError as error:
        _refuse(control, "the supervisor of a fork", error)


def _refuse(control: int, what: str, error: OSError) -> NoReturn:
    refusal = {"absent": False, "what": what, "why": error.strerror or str(error)}
    os.write(control, json.dumps({"refused": refusal}).encode() + b"\n")
    os._exit(1)


def _begin(ready: int, given: list[int], folder: str, rights: _Rights) -> None:
    """In the program's process: waits for its cell, and leaves behind what is the server's."""
    os.setpgid(0, 0)
    if not os.read(ready, 1):
        os._exit(1)  # there is no cell
    # By way of high numbers, since the low ones may be among those given.
    for place, descriptor in enumerate([os.open("/dev/null", os.O_RDONLY), *given]):
        os.dup2(descriptor, _HIGH + place)
    for place in range(1 + len(given)):
        os.dup2(_HIGH + place, place)
    os.closerange(1 + len(given), _HIGH + 1 + len(given))
    rights.give_up()
    os.chdir(folder)


class _Rights:
    """What this process may do to the machine (capabilities(7)): the server keeps it for its forks, which make cells, and does
    without while it imports."""

    def __init__(self, beyond: int) -> None:
        """`beyond` has a bit for each right that reaches beyond a cell."""
        self._beyond = beyond
        self.libc = ctypes.CDLL(None, use_errno=True)
        self._header = (ctypes.c_uint32 * 2)(_CAPABILITY_VERSION, 0)
        # Effective, permitted and inheritable rights: their lower halves, then their upper ones.
        self._own = (ctypes.c_uint32 * 6)()
        self._check(self.libc.capget(self._header, self._own))

    def lay_down(self) -> None:
        """Does without them, until they are taken up again."""
        self._set(~self._beyond)

    def take_up(self) -> None:
        """Has them again."""
        self._set(-1)

    def enter(self, namespaces: int) -> None:
        """Enters new namespaces; of processes, with its next fork."""
        self._check(self.libc.unshare(namespaces), "new namespaces")

    def leave(self, processes: int) -> None:
        """Lets what is forked from here on be in the namespace of processes that the descriptor stands for."""
        self._check(self.libc.setns(processes, _NEW_PROCESSES), "a namespace of processes")

    def give_up(self) -> None:
        """Does without them for good; who is not root has no others."""
        kept = ~self._beyond if os.geteuid() == 0 else 0
        self._check(self.libc.prctl(_CAP_AMBIENT, _CLEAR_ALL, 0, 0, 0))
        for right in range(self._beyond.bit_length()):
            if self._beyond >> right & 1:
                self.libc.prctl(_CAPBSET_DROP, right, 0, 0, 0)  # one that the kernel does not know cannot be had
        permitted = self._own[1] | self._own[4] << 32
        self._own[1], self._own[4] = permitted & kept & 0xFFFFFFFF, (permitted & kept) >> 32
        self._own[2] = self._own[5] = 0
        self._set(-1)

    def _set(self, mask: int) -> None:
        """Has in effect those of the permitted rights that are in the mask."""
        mask &= (1 << 64) - 1
        wanted = (ctypes.c_uint32 * 6)(*self._own)
        wanted[0], wanted[3] = self._own[1] & mask & 0xFFFFFFFF, self._own[4] & mask >> 32
        self._check(self.libc.capset(self._header, wanted))

    def _check(self, result: int, what: str = "rights of a process") -> None:
        if result:
            number = ctypes.get_errno()
            raise OSError(number, "%s: %s" % (what, os.strerror(number)))
