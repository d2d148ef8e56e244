"""`Node`: the robot program's view of the world."""

from __future__ import annotations

import atexit
import os
import sys

from hrdsl import link as _links
from hrdsl.errors import ProtocolError
from hrdsl.events import Ending
from hrdsl.exchange import the_exchange

TYPE_CHECKING = False  # as type checkers read it; `typing` takes longer to import than all of this package
if TYPE_CHECKING:
    from typing import Any, Iterable, TypeVar, Union

    from hrdsl.exchange import Exchange

    Value = Union[bool, int, float, str]
    Kind = TypeVar("Kind", bound="Device")


class Event:
    """Something that happened: its `name`, its arguments (`event.args["ready"]` or `event.ready`), and its `time` in
    simulated seconds."""

    __slots__ = ("name", "args", "time")

    def __init__(self, name: str, args: dict[str, Any], time: float) -> None:
        self.name = name
        self.args = args
        self.time = time

    def __getattr__(self, name: str) -> Any:
        if name in self.__slots__:  # of an event that is just being copied
            raise AttributeError(name)
        try:
            return self.args[name]
        except KeyError:
            raise AttributeError("event %s has no argument %r" % (self.name, name)) from None

    def __repr__(self) -> str:
        args = ", ".join("%s=%r" % item for item in sorted(self.args.items()))
        return "Event(%s(%s) at %.3f s)" % (self.name, args, self.time)


class Motion(Ending):
    """A command that a device carries out while the program goes on. A later command to the same device ends it; it has
    failed then."""

    def __init__(self, exchange: Exchange, device: Device, command: str, args: dict[str, Any]) -> None:
        super().__init__()
        self._exchange = exchange
        self.device = device
        self.command = command
        self.error: str | None = None  # why it has failed
        exchange.act(device.name, command, args, self._end)

    def _end(self, error: str | None) -> None:
        self.error = error
        self._exchange.events.ended(self)

    def done(self) -> bool:
        """Whether it has ended."""
        if not self._place:
            self._exchange.polled("motion")
        return bool(self._place)

    def wait(self, timeout: float | None = None) -> bool | None:
        """Waits for its end: whether it succeeded; `None` when `timeout` has passed before."""
        deadline = None if timeout is None else _after(self._exchange, timeout)
        if self._exchange.events.wait(frozenset(), (self,), deadline) is None:
            return None
        return self.error is None

    def __repr__(self) -> str:
        state = "under way" if not self._place else "succeeded" if self.error is None else "failed: %s" % self.error
        return "Motion(%s of %s, %s)" % (self.command, self.device.name, state)


class Device:
    """Something that takes commands."""

    def __init__(self, exchange: Exchange, name: str) -> None:
        self._exchange = exchange
        self.name = name
        self.last_error: str | None = None  # why the last command failed

    def begin(self, command: str, /, **args: Any) -> Motion:
        """Gives the device a command that it is declared to have, and returns at once. An argument that is `None` is left out."""
        return Motion(self._exchange, self, command, {key: value for key, value in args.items() if value is not None})

    def command(self, command: str, /, **args: Any) -> bool:
        """Gives the device a command that it is declared to have, and returns when that has ended: whether it succeeded. An
        argument that is `None` is left out."""
        motion = self.begin(command, **args)
        motion.wait()
        self.last_error = motion.error
        return motion.error is None

    def state(self, what: str) -> list[float]:
        """How the device is now, in SI units: `joints`, `speeds` or `tool` of an arm, `fingers` of a gripper, `pose`, `orientation` or
        `velocity` of a base, `ranges`, `angles` or `limits` of a laser, and what the scenario declares beside them. An imperfect sensor that
        shows nothing says NaN. Raises `ProtocolError` if it has no such state."""
        return self._exchange.state(self.name, what)


class Arm(Device):
    """A chain of joints under motor control. Motions return when they end: whether the target was reached."""

    def move_to(self, place: Iterable[float], speed: float | None = None) -> bool:
        """Brings the tool to a place (x, y, z; metres); `speed` limits the joints (rad/s)."""
        return self.command("move_to", to=_numbers(place, 3), speed=speed)

    def move_joints(self, angles: Iterable[float], speed: float | None = None) -> bool:
        """Brings the joints to these angles (radians, from the base to the tip)."""
        return self.command("move_joints", to=_numbers(angles, None), speed=speed)


    def follow(self, positions: Iterable[Iterable[float]], times: Iterable[float]) -> bool:
        """Brings the joints through postures (radians, from the base to the tip), each at its time (seconds from now)."""
        postures = [_numbers(posture, None) for posture in positions]
        instants = [_seconds(time) for time in times]
        if len(postures) != len(instants):
            raise ValueError("%d postures and %d times: each posture has a time" % (len(postures), len(instants)))
        if len({len(posture) for posture in postures}) > 1:
            raise ValueError("all postures of a trajectory have as many joints")
        return self.command("follow", positions=sum(postures, []), times=instants)

    def aim(self, joint: int, angle: float) -> bool:
        """Lets one joint (from 0, counted from the base) aim at an angle (radians) from now on; returns at once."""
        return self.command("aim", joint=joint, to=float(angle))

    def stop(self) -> bool:
        """Gives up what the arm is doing, and brakes."""
        return self.command("stop")


class Base(Device):
    """What drives on the ground."""

    def drive(self, forward: float, turn: float = 0.0, sideways: float | None = None) -> bool:
        """Lets the base go at a velocity (m/s; rad/s to the left; m/s to the left, if it can) from now on, as long as its timeout is;
        returns at once."""
        return self.command("drive", forward=float(forward), turn=float(turn), sideways=sideways)

    def stop(self) -> bool:
        """Brakes, and returns when the base stands."""
        return self.command("stop")


class Laser(Device):
    """What measures how far it is to the next surface, all around."""

    def ranges(self) -> list[float]:
        """How far it is along each beam, in metres: infinite if nothing is met, minus infinite if something is too near, NaN where an
        imperfect one shows nothing."""
        return self.state("ranges")


class Gripper(Device):
    """A hand. Both calls return when the hand has done it; `close` says whether it now holds something."""

    def close(self) -> bool:
        return self.command("close")

    def open(self) -> bool:
        return self.command("open")


class Node:
    """The program's end of the harness: events, signals, devices and simulated time. Times are in seconds."""

    def __init__(self, name: str) -> None:
        self._link = _links.the_link()
        self._link.hello(name)
        self._exchange = the_exchange()
        self._devices: dict[tuple[type[Device], str], Any] = {}
        self.name = name
        self.seed = int(os.environ.get("HRDSL_SEED", "0"))
        if "hrdsl.runner" not in sys.modules:
            atexit.register(_farewell, self._link)

    def now(self) -> float:
        """Simulated seconds since the start of the test."""
        return self._link.now() / 1e9

    def sleep(self, seconds: float) -> None:
        """Lets simulated time pass."""
        self._link.sleep(_seconds(seconds))

    def emit(self, event: str, **args: Value) -> None:
        """Makes an event of the scenario's vocabulary happen now; a value of an enumeration is its name, a str."""
        self._link.request({"request": "emit", "event": event, "args": args})

    def wait_for(self, *what: str | Motion, timeout: float | None = None) -> Any:
        """Takes the first of these events out of the mailbox, or waits for one; `None` when `timeout` has passed. Among them may
        be motions: one that has ended is returned itself, if it ended before the event came."""
        if not what:
            raise ProtocolError("wait_for needs the name of an event")
        deadline = None if timeout is None else _after(self._exchange, timeout)
        events = self._exchange.events
        names = [each for each in what if not isinstance(each, Motion)]
        events.check(names)
        motions = tuple(each for each in what if isinstance(each, Motion))
        found = events.wait(frozenset(names), motions, deadline)
        if found is None or isinstance(found, Motion):
            return found
        return Event(found["name"], found.get("args", {}), found["time"] / 1e9)

    def drop(self, *events: str) -> None:
        """Forgets these events in the mailbox; without names, all."""
        self._exchange.events.drop(events)

    def read(self, signal: str) -> Any:
        """The present value of a signal: a bool, an int, a float in SI units, or the name of an enumeration's value."""
        return self._link.request({"request": "read", "signal": signal})["value"]

    def arm(self, name: str) -> Arm:
        """The arm of this name; always the same object."""
        return self._device(Arm, name)

    def gripper(self, name: str) -> Gripper:
        """The gripper of this name; always the same object."""
        return self._device(Gripper, name)

    def base(self, name: str) -> Base:
        """The base of this name; always the same object."""
        return self._device(Base, name)

    def laser(self, name: str) -> Laser:
        """The laser of this name; always the same object."""
        return self._device(Laser, name)

    def device(self, name: str) -> Device:
        """The device of this name, whatever its kind; always the same object."""
        return self._device(Device, name)

    def _device(self, kind: type[Kind], name: str) -> Kind:
        if (kind, name) not in self._devices:
            self._devices[kind, name] = kind(self._exchange, name)
        device: Kind = self._devices[kind, name]
        return device


def _farewell(link: _links.Link) -> None:
    # Outside the runner: an uncaught exception leaves its type here, and is no normal end.
    if not hasattr(sys, "last_type"):
        link.done()


def _seconds(value: float) -> float:
    value = float(value)
    if not value >= 0.0 or value == float("inf"):
        raise ValueError("a duration must be finite and not negative: %r" % value)
    return value


def _after(exchange: Exchange, timeout: float) -> int:
    return exchange.time + round(min(_seconds(timeout), 1e10) * 1e9)  # later than any time of the harness


def _numbers(values: Iterable[float], count: int | None) -> list[float]:
    numbers = [float(value) for value in values]
    if count is not None and len(numbers) != count:
        raise ValueError("a place has %d coordinates, not %d" % (count, len(numbers)))
    return numbers
