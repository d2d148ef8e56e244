"""The tree of frames, and where they were to each other, for both clients. The original is a library in C++."""

from __future__ import annotations

import math
import sys

from hrdsl.frames import rigid
from hrdsl.frames import cache as _cache
from hrdsl.frames.exceptions import (
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TransformException,
)

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Callable

    Place = tuple[tuple[float, ...], tuple[float, ...]]

#: Who has more frames above a frame has a loop.
_DEEPEST = 1000

_NOWHERE: Place = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)


def _then(outer: Place, inner: Place) -> Place:
    """A place within a place."""
    moved = rigid.rotate(outer[1], inner[0])
    return tuple(a + b for a, b in zip(moved, outer[0])), rigid.multiply(outer[1], inner[1])


def _back(place: Place) -> Place:
    turned = rigid.conjugate(place[1])
    return rigid.rotate(turned, tuple(-number for number in place[0])), turned


def _strip(frame: str) -> str:
    return frame[1:] if frame.startswith("/") else frame


def _say(level: str, text: str) -> None:
    sys.stderr.write("%s: %s\n" % (level, text))


class FrameTree:
    """Where frames were, for the last ten seconds or for a duration of the client."""

    def __init__(self, cache_time: Any = None) -> None:
        self._longest = 10_000_000_000 if cache_time is None else self._nanoseconds(cache_time)
        self._frames: dict[str, Any] = {}  # None for those without a parent
        self._authorities: dict[str, str] = {}
        self._waiting: list[Callable[[], object]] = []  # called when something new is known

    # ── how the client tells times ──

    def _nanoseconds(self, time: Any) -> int:
        raise NotImplementedError

    def _time(self, nanoseconds: int) -> Any:
        raise NotImplementedError

    def _stamp(self, nanoseconds: int) -> Any:
        """The same for a header."""
        raise NotImplementedError

    # ── what is heard ──

    def set_transform(self, transform: Any, authority: str) -> bool:
        """Hears where a frame was at a time."""
        return self._set(transform, authority, False)

    def set_transform_static(self, transform: Any, authority: str) -> bool:
        """Hears where a frame is at all times."""
        return self._set(transform, authority, True)

    def _set(self, transform: Any, authority: str, is_static: bool) -> bool:
        parent, child = _strip(transform.header.frame_id), _strip(transform.child_frame_id)
        moved, turned = transform.transform.translation, transform.transform.rotation
        place = (moved.x, moved.y, moved.z), (turned.x, turned.y, turned.z, turned.w)
        if not self._is_sound(parent, child, place, authority):
            return False
        kept = self._frames.get(child)
        if kept is None:
            kept = self._frames[child] = _cache.make(is_static, self._longest)
        self._frames.setdefault(parent, None)
        stamp = self._nanoseconds(transform.header.stamp)
        wrong = kept.insert(stamp, (parent, *place))
        if wrong:
            text = "%s for frame %s (parent %s) at time %f according to authority %s"
            _say("Warning", text % (wrong, child, parent, stamp / 1e9, authority))
            return False
        self._authorities[child] = authority
        for call in self._waiting:
            call()
        return True

    def _is_sound(self, parent: str, child: str, place: Place, authority: str) -> bool:
        wrong = []
        if child == parent:
            text = 'TF_SELF_TRANSFORM: Ignoring transform from authority "%s" with frame_id and child_frame_id  "%s" because'
            wrong.append((text + " they are the same") % (authority, child))
        if not child:
            text = 'TF_NO_CHILD_FRAME_ID: Ignoring transform from authority "%s" because child_frame_id not set '
            wrong.append(text % authority)
        if not parent:
            text = 'TF_NO_FRAME_ID: Ignoring transform with child_frame_id "%s"  from authority "%s" because frame_id not set'
            wrong.append(text % (child, authority))
        numbers = place[0] + place[1]
        if any(math.isnan(number) for number in numbers):
            text = (
                'TF_NAN_INPUT: Ignoring transform for child_frame_id "%s" from authority "%s" because of a nan value in the'
                " transform (%f %f %f) (%f %f %f %f)"
            )
            wrong.append(text % (child, authority, *numbers))
        if not abs(sum(number * number for number in place[1]) - 1.0) < 1e-3:
            text = (
                'TF_DENORMALIZED_QUATERNION: Ignoring transform for child_frame_id "%s" from authority "%s" because of an'
                " invalid quaternion in the transform (%f %f %f %f)"
            )
            wrong.append(text % (child, authority, *place[1]))
        for text in wrong:
            _say("Error", text)
        return not wrong

    def clear(self) -> None:
        """Forgets where frames were; what is static stays."""
        for kept in self._frames.values():
            if kept is not None:
                kept.clear()

    # ── what is asked ──

    def lookup_transform_core(self, target_frame: str, source_frame: str, time: Any) -> Any:
        """Where `source_frame` was, as seen from `target_frame`, as a `TransformStamped`."""
        stamp = self._nanoseconds(time)
        if target_frame == source_frame:
            kept = self._frames.get(target_frame)
            stamp = stamp or (kept.latest()[0] if kept is not None else 0)
            return self._message(target_frame, source_frame, stamp, _NOWHERE)
        self._check("lookupTransform argument target_frame", target_frame)
        self._check("lookupTransform argument source_frame", source_frame)
        stamp = stamp or self._latest_common(target_frame, source_frame)
        return self._message(target_frame, source_frame, stamp, self._walk(target_frame, source_frame, stamp))

    def lookup_transform_full_core(
        self, target_frame: str, target_time: Any, source_frame: str, source_time: Any, fixed_frame: str
    ) -> Any:
        """The same between two times, with a frame that did not move between them."""
        self._check("lookupTransform argument target_frame", target_frame)
        self._check("lookupTransform argument source_frame", source_frame)
        self._check("lookupTransform argument fixed_frame", fixed_frame)
        inner = self.lookup_transform_core(fixed_frame, source_frame, source_time)
        outer = self.lookup_transform_core(target_frame, fixed_frame, target_time)
        place = _then(_of(outer), _of(inner))
        return self._message(target_frame, source_frame, self._nanoseconds(outer.header.stamp), place)

    def can_transform_core(self, target_frame: str, source_frame: str, time: Any) -> tuple[bool, str]:
        """Whether `lookup_transform_core` knows, and if not, why."""
        stamp = self._nanoseconds(time)
        if target_frame == source_frame:
            return True, ""
        return self._can((("target_frame", target_frame), ("source_frame", source_frame)), ((0, 1, stamp),))

    def can_transform_full_core(
        self, target_frame: str, target_time: Any, source_frame: str, source_time: Any, fixed_frame: str
    ) -> tuple[bool, str]:
        """Whether `lookup_transform_full_core` knows, and if not, why."""
        names = ("target_frame", target_frame), ("source_frame", source_frame), ("fixed_frame", fixed_frame)
        return self._can(names, ((0, 2, self._nanoseconds(target_time)), (2, 1, self._nanoseconds(source_time))))

    def _can(self, names: Any, ways: Any) -> tuple[bool, str]:
        for role, frame in names:
            wrong = self._wrong("canTransform argument " + role, frame)
            if wrong:
                _say("Warning", wrong)
                return False, ""
        missing = ["canTransform: %s %s does not exist." % (role, frame) for role, frame in names if frame not in self._frames]
        if missing:
            return False, " ".join(missing)
        try:
            for target, source, stamp in ways:
                if target != source and names[target][1] != names[source][1]:
                    self._walk(names[target][1], names[source][1], stamp)
        except TransformException as error:
            return False, str(error)
        return True, ""

    def get_latest_common_time(self, target_frame: str, source_frame: str) -> Any:
        """The latest time at which it is known where they were to each other."""
        self._check("getLatestCommonTime argument target_frame", target_frame)
        self._check("getLatestCommonTime argument source_frame", source_frame)
        return self._time(self._latest_common(target_frame, source_frame))

    def _message(self, target: str, source: str, stamp: int, place: Place) -> Any:
        from geometry_msgs.msg import TransformStamped

        made = TransformStamped()
        made.header.stamp = self._stamp(stamp)
        made.header.frame_id, made.child_frame_id = target, source
        moved, turned = made.transform.translation, made.transform.rotation
        moved.x, moved.y, moved.z = place[0]
        turned.x, turned.y, turned.z, turned.w = place[1]
        return made

    def _wrong(self, function: str, frame: str) -> str:
        if not frame:
            return "Invalid argument passed to %s in tf2 frame_ids cannot be empty" % function
        if frame.startswith("/"):
            text = "Invalid argument \"%s\" passed to %s in tf2 frame_ids cannot start with a '/' like: "
            return text % (frame, function)
        return ""

    def _check(self, function: str, frame: str) -> None:
        wrong = self._wrong(function, frame)
        if wrong:
            raise InvalidArgumentException(wrong)
        if frame not in self._frames:
            raise LookupException('"%s" passed to %s does not exist. ' % (frame, function))

    # ── the tree ──

    def _walk(self, target: str, source: str, stamp: int) -> Place:
        """Goes up from the source, and then from the target until that meets the same frame."""
        stamp = stamp or self._latest_common(target, source)
        up, lost, frame = _NOWHERE, "", source
        seen = 0
        while self._frames[frame] is not None:
            try:
                parent, *place = self._frames[frame].get(stamp)
            except _cache.Missing as missing:
                lost = str(missing) or "No data"
                break
            if frame == target:
                return up
            up, frame, seen = _then((place[0], place[1]), up), parent, self._deeper(seen)
        top, down, frame, seen = frame, _NOWHERE, target, 0
        while frame != top and self._frames[frame] is not None:
            try:
                parent, *place = self._frames[frame].get(stamp)
            except _cache.Missing as missing:
                raise ExtrapolationException(self._between(str(missing), source, target)) from None
            if frame == source:
                return _back(down)
            down, frame, seen = _then((place[0], place[1]), down), parent, self._deeper(seen)
        if frame != top:
            if lost:
                raise ExtrapolationException(self._between(lost, source, target))
            raise self._unconnected(target, source)
        return _then(_back(down), up)

    def _between(self, text: str, source: str, target: str) -> str:
        return "%s, when looking up transform from frame [%s] to frame [%s]" % (text, source, target)

    def _unconnected(self, target: str, source: str) -> TransformException:
        text = "Could not find a connection between '%s' and '%s' because they are not part of the same tree."
        return ConnectivityException((text + "Tf has two or more unconnected trees.") % (target, source))

    def _deeper(self, seen: int) -> int:
        if seen >= _DEEPEST:
            text = "The tf tree is invalid because it contains a loop.\n%s\n"
            raise LookupException(text % self.all_frames_as_string())
        return seen + 1

    def _latest_common(self, target: str, source: str) -> int:
        """The earliest of the last times of all frames between them; 0 if all of them are static."""
        if target == source:
            kept = self._frames[source]
            return 0 if kept is None else int(kept.latest()[0])
        above: list[tuple[str, int]] = []  # the source's ancestors, and the times of what is below them
        for parent, stamp in self._ancestors(source):
            above.append((parent, stamp))
            if parent == target:
                return _earliest(stamp for _, stamp in above)
        stamps = []
        for parent, stamp in self._ancestors(target):
            stamps.append(stamp)
            for at, (other, _) in enumerate(above):
                if other == parent:
                    return _earliest(stamps + [stamp for _, stamp in above[: at + 1]])
            if parent == source:
                return _earliest(stamps)
        raise self._unconnected(target, source)

    def _ancestors(self, frame: str) -> Any:
        seen = 0
        while self._frames[frame] is not None:
            stamp, parent = self._frames[frame].latest()
            if parent is None:
                return
            yield parent, stamp
            frame, seen = parent, self._deeper(seen)

    # ── descriptions ──

    def _with_parents(self) -> list[str]:
        return [name for name, kept in self._frames.items() if kept is not None and kept.latest()[1] is not None]

    def _frameExists(self, frame: str) -> bool:
        return frame in self._frames

    def _getFrameStrings(self) -> list[str]:
        return list(self._frames)

    def _chain(self, target: str, target_time: Any, source: str, source_time: Any, fixed: str) -> list[str]:
        up = self._path(fixed, source, self._nanoseconds(source_time))
        down = self._path(target, fixed, self._nanoseconds(target_time))
        return up[:-1] + down if up[-1:] == down[:1] else up + down

    def _path(self, target: str, source: str, stamp: int) -> list[str]:
        """The frames on the way from one to the other; none, if they are the same."""
        for frame in (target, source):
            self._check("chain", frame)
        if target == source:
            return []
        self._walk(target, source, stamp)
        up, down = self._above(source, stamp), self._above(target, stamp)
        meeting = next(frame for frame in up if frame in down)
        return up[: up.index(meeting) + 1] + down[: down.index(meeting)][::-1]

    def _above(self, frame: str, stamp: int) -> list[str]:
        found = [frame]
        while self._frames[found[-1]] is not None and len(found) < _DEEPEST:
            try:
                found.append(self._frames[found[-1]].get(stamp)[0])
            except _cache.Missing:
                break
        return found

    def all_frames_as_string(self) -> str:
        """All frames with their parents, a line for each."""
        lines = []
        for name, kept in self._frames.items():
            if kept is not None:
                lines.append("Frame %s exists with parent %s.\n" % (name, kept.latest()[1] or "NO_PARENT"))
        return "".join(lines)

    def all_frames_as_yaml(self) -> str:
        """All frames with what is known of them."""
        text = "" if self._frames else "{}"
        for name in self._with_parents():
            kept = self._frames[name]
            (last, parent), first = kept.latest(), kept.oldest()
            length = (last - first) / 1e9
            text += "%s: \n  parent: '%s'\n" % (name, parent)
            text += "  broadcaster: '%s'\n" % self._authorities.get(name, "no recorded authority")
            text += "  rate: %.3f\n" % (len(kept) / max(length, 0.0001))
            text += "  most_recent_transform: %.3f\n" % (last / 1e9)
            text += "  oldest_transform: %.3f\n  buffer_length: %.3f\n" % (first / 1e9, length)
        return text

    def _allFramesAsDot(self, current_time: Any = None) -> str:
        lines = ['"%s" -> "%s";' % (self._frames[name].latest()[1], name) for name in self._with_parents()]
        return "digraph G {\n%s\n}" % "\n".join(lines)


def _earliest(stamps: Any) -> int:
    return min((stamp for stamp in stamps if stamp), default=0)


def _of(message: Any) -> Place:
    moved, turned = message.transform.translation, message.transform.rotation
    return (moved.x, moved.y, moved.z), (turned.x, turned.y, turned.z, turned.w)
