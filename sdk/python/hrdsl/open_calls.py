"""Calls of services that have no answer when the test ends. Two programs that wait for each other would end it without a word."""

from __future__ import annotations

import sys

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from hrdsl.exchange import Port


class OpenCalls:
    """Of one program: those that it has made, and those that others have made of it."""

    def __init__(self) -> None:
        self._asked: dict[int, tuple[Port, int, str]] = {}
        self._asked_of: dict[int, tuple[Port, int]] = {}

    def ask(self, number: int, port: Port, now: int) -> None:
        """The program asks a service."""
        from hrdsl import report

        self._asked[number] = port, now, report.site(sys._getframe(1))

    def answered(self, number: int) -> None:
        """And is answered."""
        self._asked.pop(number, None)

    def arrive(self, number: int, port: Port, now: int) -> None:
        """The program is asked."""
        self._asked_of[number] = port, now

    def answer(self, number: int) -> None:
        """And answers."""
        self._asked_of.pop(number, None)

    def report(self) -> str:
        """What is said of those that have waited when the test ends; empty if nothing is."""
        lines = [
            "hrdsl: at the end the %s has no answer to its call of %.3f s, in %s\n" % (port, since / 1e9, where)
            for port, since, where in self._asked.values()
        ]
        if lines:
            lines += [
                "hrdsl: nor has this program answered a call of %s (%s) of %.3f s: programs that wait for each other never go on\n"
                % (port.name, port.type_name, since / 1e9)
                for port, since in self._asked_of.values()
            ]
        return "".join(lines)
