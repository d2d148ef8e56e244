"""Where packages are: those that the binding file names."""

from __future__ import annotations

import os

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class ResourceNotFound(Exception):
    """There is no such package."""

    def __init__(self, msg: str, ros_paths: Any = None) -> None:
        super().__init__(msg)
        self.ros_paths = ros_paths

    def __str__(self) -> str:
        text = str(self.args[0])
        for number, path in enumerate(self.ros_paths or []):
            text += "\nROS path [%s]=%s" % (number, path)
        return text


class RosPack:
    """The packages."""

    def __init__(self, ros_paths: Any = None) -> None:
        from hrdsl.binding import binding

        self._packages: dict[str, str] = dict(binding().get("packages", {}))
        self.ros_paths = get_ros_paths()

    @classmethod
    def get_instance(cls, ros_paths: Any = None) -> RosPack:
        return cls(ros_paths)

    def list(self) -> list[str]:
        """Their names."""
        return sorted(self._packages)

    def get_path(self, name: str) -> str:
        """The folder of a package; raises `ResourceNotFound`."""
        try:
            return self._packages[name]
        except KeyError:
            raise ResourceNotFound(name, ros_paths=self.ros_paths) from None

    def get_ros_paths(self) -> Any:
        return self.ros_paths

    def __getattr__(self, name: str) -> Any:
        raise NotImplementedError("rospkg.RosPack.%s: hrdsl knows where packages are, and not what they depend on" % name)


class RosStack(RosPack):
    """As `RosPack`."""


def get_ros_paths(env: Any = None) -> list[str]:
    paths: str = (os.environ if env is None else env).get("ROS_PACKAGE_PATH", "")
    return [path for path in paths.split(os.pathsep) if path]


def get_ros_package_path(env: Any = None) -> Any:
    return (os.environ if env is None else env).get("ROS_PACKAGE_PATH")


def get_ros_root(env: Any = None) -> Any:
    return (os.environ if env is None else env).get("ROS_ROOT")


def get_ros_home(env: Any = None) -> str:
    home: str = (os.environ if env is None else env).get("ROS_HOME", os.path.join(os.path.expanduser("~"), ".ros"))
    return home


def get_log_dir(env: Any = None) -> str:
    return os.path.join(get_ros_home(env), "log")


def get_package_name(path: str) -> str | None:
    """The package in which a file lies, if it lies in one."""
    folder = os.path.abspath(path)
    while True:
        if os.path.exists(os.path.join(folder, "package.xml")):
            return os.path.basename(folder)
        folder, last = os.path.dirname(folder), folder
        if folder == last:
            return None
