"""The modules `PACKAGE.msg`, `PACKAGE.srv` and `PACKAGE.action` of ROS packages, from the table of definitions in the binding
file (spec/messages.md). Their classes are made when they are first asked for, by the factory of the ROS that is spoken."""

from __future__ import annotations

import sys

from hrdsl.binding import binding

TYPE_CHECKING = False  # as type checkers read it; importing `typing` takes long
if TYPE_CHECKING:
    from types import ModuleType
    from typing import Any

#: The modules that make classes, by the ROS that is spoken: `make_class`, `make_service`, and `make_action` for ROS 2.
_FACTORIES = {1: "genpy.factory", 2: "rosidl_classes"}

_SPACES = {"messages": "msg", "services": "srv", "actions": "action"}


class Interfaces:
    """A table of definitions, and the classes made of it so far. In ROS 1 a message, a service and an action may have one name."""

    def __init__(self, table: dict[str, Any]) -> None:
        self.ros: int = table.get("ros", 1)
        self.tables: dict[str, dict[str, dict[str, Any]]] = {}  # definitions by `messages`, `services`, `actions` and names
        self.spaces: dict[str, dict[str, tuple[str, str]]] = {}  # the same two by `PACKAGE.SPACE` and names of classes
        self._classes: dict[tuple[str, str], Any] = {}
        self._factory: Any = None
        for kind, space in _SPACES.items():
            self.tables[kind] = {}
            for definition in table.get(kind, ()):
                self._add(kind, definition.get("space", space), definition)

    def _add(self, kind: str, space: str, definition: dict[str, Any]) -> None:
        name = definition["name"]
        self.tables[kind][name] = definition
        if self.ros != 1 or kind != "actions":  # which are no classes of their own in ROS 1
            package, _, own = name.partition("/")
            self.spaces.setdefault("%s.%s" % (package, space), {})[own.rpartition("/")[2]] = (kind, name)

    def packages(self) -> set[str]:
        """Those that have definitions."""
        return {space.partition(".")[0] for space in self.spaces}

    def find(self, name: str) -> tuple[str, str] | None:
        """What `PACKAGE/NAME` or `PACKAGE/SPACE/NAME` is in the tables: of several, a message before a service before an action."""
        parts = name.split("/")
        spaces = [parts[1]] if len(parts) == 3 else ["msg", "srv", "action"]
        for space in spaces:
            found = self.spaces.get("%s.%s" % (parts[0], space), {}).get(parts[-1])
            if found is not None:
                return found
        short = "%s/%s" % (parts[0], parts[-1])
        return ("actions", short) if short in self.tables["actions"] and "action" in spaces else None

    def message_class(self, name: str) -> Any:
        """The class of a message, by its name in the table; always the same."""
        return self.class_of("messages", name)

    def class_of(self, kind: str, name: str) -> Any:
        """The class of a definition, by its name in the table of this kind; always the same."""
        found = self._classes.get((kind, name))
        if found is None:
            if self._factory is None:
                self._factory = __import__(_FACTORIES[self.ros], fromlist=["make_class"])
            make = {"messages": "make_class", "services": "make_service", "actions": "make_action"}[kind]
            found = getattr(self._factory, make)(self.tables[kind][name], self.message_class)
            self._classes[kind, name] = found
        return found


_interfaces: Interfaces | None = None


def interfaces() -> Interfaces:
    """Those of the binding file."""
    global _interfaces
    if _interfaces is None:
        _interfaces = Interfaces(binding().get("interfaces", {}))
    return _interfaces


def _found(name: str) -> tuple[str, str]:
    found = interfaces().find(name)
    if found is None:
        raise LookupError("no definition of %s: the scenario's interfaces do not have it" % name)
    return found


def definition(name: str) -> dict[str, Any]:
    """The definition of a message, service or action; raises `LookupError`."""
    kind, full = _found(name)
    return interfaces().tables[kind][full]


def class_of(name: str) -> Any:
    """The class of a message, service or action; raises `LookupError`."""
    return interfaces().class_of(*_found(name))


def install() -> None:
    """Lets the modules be imported."""
    if not any(isinstance(finder, _Finder) for finder in sys.meta_path):
        # What is found on the path may be a package of the same name; its messages are these all the same.
        sys.meta_path.insert(0, _Finder(False))
        sys.meta_path.append(_Finder(True))


class _Finder:
    """Finds the modules of definitions, or the packages that hold them."""

    def __init__(self, of_packages: bool) -> None:
        self._of_packages = of_packages

    def find_spec(self, name: str, path: Any = None, target: Any = None) -> Any:
        package, _, rest = name.partition(".")
        is_package = not rest
        if is_package is not self._of_packages or rest.partition(".")[0] not in ("", "msg", "srv", "action"):
            return None
        known = interfaces()
        if is_package:
            if package not in known.packages():
                return None
        elif rest.count(".") > 1 or not known.spaces.get(".".join(name.split(".")[:2])):
            return None
        elif "." in rest and not _of_file(known, name):
            return None
        from importlib.machinery import ModuleSpec

        spec = ModuleSpec(name, self, origin="hrdsl")  # type: ignore[arg-type]
        if rest.count(".") == 0:
            spec.submodule_search_locations = []
        return spec

    def create_module(self, spec: Any) -> None:
        return None

    def exec_module(self, module: ModuleType) -> None:
        known, name = interfaces(), module.__name__
        if name.count(".") == 2:
            for own in _of_file(known, name):
                setattr(module, own, known.class_of(*known.spaces[name.rpartition(".")[0]][own]))
            return
        names = known.spaces.get(name)
        if names is None:
            return
        place: Any = module
        place.__all__ = sorted(names)

        def get(own: str) -> Any:
            if own not in names:
                raise AttributeError("module %r has no attribute %r" % (name, own))
            found = known.class_of(*names[own])
            setattr(module, own, found)
            return found

        place.__getattr__ = get
        place.__dir__ = lambda: sorted({*vars(module), *names})


def _of_file(known: Interfaces, module: str) -> list[str]:
    """The classes in a module such as `std_msgs.msg._String`, or `std_msgs.msg._string` in ROS 2, as the originals lay them out."""
    space, _, file = module.rpartition(".")
    wanted = file.replace("_", "").lower()
    if not file.startswith("_"):
        return []
    names = known.spaces[space]
    own = [name for name in names if name.lower() == wanted]
    if own and space.endswith(".srv"):
        own += [name for name in names if name in (own[0] + "Request", own[0] + "Response")]
    return own
