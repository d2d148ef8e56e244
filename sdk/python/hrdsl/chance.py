"""All chance of the program under test comes from the test's seed."""

from __future__ import annotations

import os
import sys

from hrdsl.replace import put, when_imported

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from typing import Any, Callable

#: What `uuid.getnode` says: a locally administered address, of no machine.
NODE = 0x020000000001


def install(seed: int) -> Chance:
    """Replaces the sources of entropy, for this process."""
    chance = Chance(seed)
    system = [module for module in map(sys.modules.get, ("posix", "nt")) if module]
    put("urandom", chance.urandom, os, *system)
    put("getrandom", lambda size, flags=0: chance.urandom(size), os, *system)
    when_imported("_random", chance.generators)
    when_imported("random", lambda module: module.seed(chance.seed))
    when_imported("_ssl", chance.openssl)
    when_imported("uuid", chance.uuids)
    if hasattr(os, "register_at_fork"):
        os.register_at_fork(before=chance.before_fork, after_in_child=chance.after_fork)
    return chance


class Chance:
    """What stands for the system's entropy, in two streams: one for those who ask for entropy, one for generators that
    are given no seed. The first of those is that of the module `random`, so who imports it changes nothing else."""

    def __init__(self, seed: int) -> None:
        self.seed = seed
        self.on_draw: Callable[[], object] | None = None  # called before each
        self.is_drawn_by_forks = True  # so that the processes differ
        self._kind: Any = None  # the generator as it is
        self._replacement: Any = None  # and in its place
        self._sources: list[Any] = []

    def begin(self, seed: int) -> None:
        """The program begins with this seed, in a process that was forked for it: modules that were imported before find what
        they would have found now."""
        self.seed = seed
        self.is_drawn_by_forks = True
        self._sources = []
        random: Any = sys.modules.get("random")
        if random is not None:
            self.bits(256, 1)  # which its own generator takes at its import
            random.seed(seed)
        numpy: Any = sys.modules.get("numpy.random")
        if numpy is not None:
            numpy.set_state(numpy.MT19937().state)

    def bits(self, count: int, stream: int = 0) -> int:
        """A number of so many random bits."""
        if self.on_draw is not None:
            self.on_draw()
        if not self._sources:
            import _random  # noqa: F401  (calls `generators`)

            # Not the test's own seed, with which the numbers would be those of the module `random`.
            self._sources = [self._kind((stream << 64) + self.seed) for stream in (1, 2)]
        drawn: int = self._sources[stream].getrandbits(count)
        return drawn

    def urandom(self, size: Any) -> bytes:
        count: int = size.__index__()
        if count < 0:
            raise ValueError("negative argument not allowed")
        return self.bits(8 * count).to_bytes(count, "little") if count else b""

    def generators(self, module: Any) -> None:
        """`random.Random` and whatever else is derived from the generator written in C."""
        if module.Random is self._replacement:
            return
        real = self._kind = module.Random
        chance = self

        class Random(real):  # type: ignore[misc, valid-type]
            def __new__(cls, *args: Any, **kwargs: Any) -> Any:
                if not args or args[0] is None:  # which would read the system's entropy
                    args = (0,) + args[1:]
                return real.__new__(cls, *args, **kwargs)

            def __init__(self, a: Any = None, /) -> None:
                self.seed(a)

            def seed(self, a: Any = None, /) -> None:
                real.seed(self, chance.bits(256, 1) if a is None else a)

        Random.__module__, Random.__qualname__, Random.__doc__ = real.__module__, "Random", real.__doc__
        self._replacement = module.Random = Random

    def openssl(self, module: Any) -> None:
        put("RAND_bytes", self.urandom, module)
        put("RAND_pseudo_bytes", lambda size: (self.urandom(size), True), module)

    def uuids(self, module: Any) -> None:
        real = module.uuid1

        def uuid1(node: int | None = None, clock_seq: int | None = None) -> Any:
            # With both given, the time is asked for in Python, not in the system's library.
            if clock_seq is None:
                clock_seq = self.bits(14)
            return real(module.getnode() if node is None else node, clock_seq)

        uuid1.__module__, uuid1.__qualname__, uuid1.__doc__ = "uuid", "uuid1", real.__doc__
        module.uuid1 = uuid1
        module._node = NODE

    # Processes forked one after the other differ, as they do with real entropy.

    def before_fork(self) -> None:
        self._forked = self.bits(64) if self.is_drawn_by_forks else None

    def after_fork(self) -> None:
        if self._forked is None:
            return
        for stream, source in enumerate(self._sources):
            source.seed((stream << 64) + (3 << 66) + self._forked)
