"""What to do about a module that robot code did not find, in a line."""

from __future__ import annotations

import os
import re
import sys

# Of a project's files and folders: a search must not take longer than the test.
LOOKED_AT = 5000
NOT_OURS = ("__pycache__", "build", "hrdsl-out", "node_modules")

#: The client libraries that a binding brings, by the binding.
CLIENTS = {
    "ros1": ("rospy", "smach", "smach_ros", "actionlib", "moveit_commander", "tf", "tf2_ros", "message_filters", "rospkg", "roslib", "rosgraph"),
    "ros2": ("rclpy", "ament_index_python", "tf2_ros", "message_filters", "sensor_msgs_py"),
}

#: Modules of ROS that are not there, and what to do instead.
ABSENT = {
    "cv_bridge": "the pixels of an image are in its `data`: `numpy.frombuffer(msg.data, numpy.uint8).reshape(msg.height, msg.width, -1)`",
    "image_transport": "subscribe to the topic of the image itself",
    "image_geometry": "compute with the matrices of `sensor_msgs/CameraInfo` yourself",
    "laser_geometry": "compute the points from `angle_min`, `angle_increment` and `ranges` yourself",
    "ros_numpy": "the values of a message are in its fields: `numpy.array(msg.ranges)`",
    "ros2_numpy": "the values of a message are in its fields: `numpy.array(msg.ranges)`",
    "PyKDL": "tf.transformations and the messages of geometry_msgs have what most programs use of it",
    "dynamic_reconfigure.server": "nobody reconfigures; read parameters with rospy.get_param",
    "dynamic_reconfigure.client": "nobody is reconfigured; set parameters with rospy.set_param",
    "rosbag": "what others would say is the scenario's to publish",
    "rosbag2_py": "what others would say is the scenario's to publish",
    "rosgraph.network": "programs of a test share no network: ask rospy for topics and services",
    "rosgraph.xmlrpc": "nodes are not asked by XML-RPC: ask rospy or rosgraph.Master",
    "rosgraph.roslogging": "set the level of the log in rospy.init_node, or by `logging`",
    "roslaunch": "each node is a program of the system, with its own `run`",
    "rosparam": "read and set parameters with rospy",
    "rosnode": "ask rospy for topics and services",
    "rostopic": "ask rospy for topics and services",
    "rosservice": "ask rospy for topics and services",
    "nav2_simple_commander": "bind the actions of navigation, and use rclpy.action",
    "controller_manager": "bind the topic or the action of the controller",
    "gazebo_ros": "the world is the scenario's",
    "ament_index_python.resources": "only packages are indexed, those that `messages` names: ask ament_index_python.packages for them",
    "rosidl_runtime_py": "use what messages have themselves: `str(msg)`, `msg.get_fields_and_field_types()`, `getattr` and `setattr`",
    "tf2_kdl": "do_transform_point and its like of tf2_geometry_msgs transform the messages of geometry_msgs",
    "tf2_sensor_msgs": "read the points of the cloud, and transform each with tf2_geometry_msgs.do_transform_point",
    "tf_transformations": "put `transforms3d` into requirements.txt, and use its `euler` and `quaternions` (whose order is w, x, y, z)",
    "turtlesim": "its window does not run; name a folder of its definitions with `messages`, and bind `cmd_vel` and `pose` of the turtle",
}


def about(error: ImportError) -> str | None:
    """The line for what was not found, or None."""
    if not error.name:
        return None
    name, _, inner = error.name.partition(".")
    if not isinstance(error, ModuleNotFoundError):  # `from name import wanted`
        wanted = re.match("cannot import name '([^']*)'", str(error))
        return _beside_definitions(name, wanted.group(1)) if wanted and error.path is None and not inner else None
    told = _of_ros(error.name) or _of_ros(name)
    if told is not None:
        return told
    if inner:
        return _inside(name, inner)
    if name in getattr(sys, "stdlib_module_names", ()):
        return "`%s` belongs to Python, but %s came without it: install it there" % (name, sys.executable)
    place = _in_project(name)
    if place is None:
        told = "put `%s` into requirements.txt beside the scenario (or the package that has it)" % name
        if "HRDSL_MIDDLEWARE" in os.environ:
            told += ", or, if it is a package of a workspace, name its folder with `messages`"
        return told
    project = _project_of(place)
    if project:
        return "`%s` is at %s: put `%s` into requirements.txt beside the scenario" % (name, place, project)
    folder = os.path.dirname(place) or "."
    advice = '`%s` is at %s, where no module is looked for: add `sys.path.append("%s")` before the import, or %s'
    return advice % (name, place, folder, _on_path(folder))


def _on_path(folder: str) -> str:
    """How modules of a folder are found by code that stays as it is."""
    return "`env PYTHONPATH` to the system, and start it with `PYTHONPATH=%s hrdsl sim`" % folder


def _beside_definitions(package: str, module: str) -> str | None:
    """About a module of a package of which only the interfaces were found."""
    for inner in ("/%s.py" % module, "/%s/__init__.py" % module):
        place = _in_project(package, inner)
        if place is not None:
            told = "`%s` is at %s, where no module is looked for: add %s"
            return told % (package, place, _on_path(os.path.dirname(place) or "."))
    return None


def _of_ros(name: str) -> str | None:
    """About a module that programs find where ROS is installed."""
    if name in ABSENT:
        return "`%s` is not there without ROS: %s" % (name, ABSENT[name])
    bound = os.environ.get("HRDSL_MIDDLEWARE")
    for middleware, names in CLIENTS.items():
        if name in names and name not in CLIENTS.get(bound or "", ()):
            told = "`%s` is there for programs of a system that has a block `%s { }`" % (name, middleware)
            return told + (", and this one has `%s`" % bound if bound else "")
    return None


def _inside(name: str, inner: str) -> str | None:
    """About a module of a package that was found."""
    package = sys.modules.get(name)
    place = getattr(package, "__file__", None)
    if place is None and not list(getattr(package, "__path__", ("",))):
        return _beside_definitions(name, inner.replace(".", "/"))
    if place:
        return "`%s` at %s has no module `%s`: is it the one you mean, and new enough?" % (name, place, inner)
    # A folder without code of its own is taken for a package, as the folder of a project may be.
    for folder in getattr(package, "__path__", ()):
        project = _project_of(os.path.join(os.path.relpath(folder), inner))
        if project:
            advice = "%s is the folder of a project: put `%s` into requirements.txt beside the scenario"
            return advice % (folder, project)
    return None


def _in_project(name: str, inner: str = "") -> str | None:
    """The path of a module or package below the scenario's folder; of a package that has an inner file, if one is named."""
    looked_at = 0
    for folder, folders, files in os.walk("."):
        if "pyvenv.cfg" in files:
            folders[:] = []
            continue
        looked_at += len(folders) + len(files)
        if looked_at > LOOKED_AT:
            return None
        folders[:] = sorted(f for f in folders if not f.startswith(".") and f not in NOT_OURS)
        if inner:
            if name in folders and os.path.isfile(os.path.join(folder, name) + inner):
                return os.path.relpath(os.path.join(folder, name))
            continue
        if name + ".py" in files:
            return os.path.relpath(os.path.join(folder, name + ".py"))
        if name in folders and any(f.endswith(".py") for f in os.listdir(os.path.join(folder, name))):
            return os.path.relpath(os.path.join(folder, name))
    return None


def _project_of(place: str) -> str | None:
    """The folder above that pip can install, as requirements name it."""
    folder = os.path.dirname(place)
    while folder:
        if any(os.path.isfile(os.path.join(folder, file)) for file in ("pyproject.toml", "setup.py")):
            return "./" + folder
        folder = os.path.dirname(folder)
    return None
