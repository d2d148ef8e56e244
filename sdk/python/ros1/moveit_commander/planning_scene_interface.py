"""`PlanningSceneInterface`: objects in the robot's surroundings. They are kept, and no plan avoids them."""

from __future__ import annotations

from moveit_commander import model
from moveit_commander.exception import MoveItCommanderException

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, NoReturn, Sequence

__all__ = ["PlanningSceneInterface"]

_NOT_AVOIDED = "plans avoid what is in the scenario's world: objects of the planning scene are kept, and no plan avoids them"

#: One scene for all, as move_group has it: messages by the objects' names.
_world: dict[str, Any] = {}
_attached: dict[str, Any] = {}


def detach(name: str = "") -> bool:
    """Detaches the objects of a link, or else the object of this name, or all: whether there was one."""
    of_link = [own for own, attached in _attached.items() if attached.link_name == name]
    gone = of_link or [own for own in _attached if name in ("", own)]
    for own in gone:
        _world[own] = _attached.pop(own).object
    return bool(gone)


def _make(name: str, pose: Any, kind: int, dimensions: Sequence[float]) -> Any:
    from moveit_msgs.msg import CollisionObject
    from shape_msgs.msg import SolidPrimitive

    made = CollisionObject()
    made.operation = CollisionObject.ADD
    made.id = name
    made.header = pose.header
    shape = SolidPrimitive()
    shape.type = kind
    shape.dimensions = [float(size) for size in dimensions]
    made.primitives = [shape]
    if hasattr(made, "pose"):  # since Noetic
        made.pose = pose.pose
    else:
        made.primitive_poses = [pose.pose]
    return made


class PlanningSceneInterface:
    """Adds, attaches and removes objects."""

    def __init__(self, ns: str = "", synchronous: bool = True) -> None:
        pass

    # ── the world ──

    def add_object(self, collision_object: Any) -> None:
        """Adds a `CollisionObject`, or does with it what it says."""
        model.warn_once(_NOT_AVOIDED)
        if collision_object.operation == type(collision_object).REMOVE:
            self.remove_world_object(collision_object.id or None)
        else:
            _world[collision_object.id] = collision_object

    def add_box(self, name: str, pose: Any, size: Sequence[float] = (1, 1, 1)) -> None:
        """Adds a box with its middle at a `PoseStamped`."""
        self.add_object(self.make_box(name, pose, size))

    def add_sphere(self, name: str, pose: Any, radius: float = 1) -> None:
        """Adds a sphere."""
        self.add_object(self.make_sphere(name, pose, radius))

    def add_cylinder(self, name: str, pose: Any, height: float, radius: float) -> None:
        """Adds a cylinder."""
        self.add_object(self.make_cylinder(name, pose, height, radius))

    def add_cone(self, name: str, pose: Any, height: float, radius: float) -> None:
        """Adds a cone."""
        self.add_object(self.make_cone(name, pose, height, radius))

    def add_plane(self, name: str, pose: Any, normal: Sequence[float] = (0, 0, 1), offset: float = 0) -> None:
        """Adds a plane."""
        self.add_object(self.make_plane(name, pose, normal, offset))

    def add_mesh(self, name: str, pose: Any, filename: str, size: Sequence[float] = (1, 1, 1)) -> NoReturn:
        """Refused."""
        raise MoveItCommanderException(
            "meshes are not read in hrdsl (%s): add a box of the same size (add_box), since no plan avoids objects anyway"
            % filename
        )

    def remove_world_object(self, name: str | None = None) -> None:
        """Removes an object, or all."""
        if name is None:
            _world.clear()
        else:
            _world.pop(name, None)

    def clear(self) -> None:
        """Removes all objects, attached ones, too."""
        _world.clear()
        _attached.clear()

    # ── attached objects ──

    def attach_object(self, object: Any, link: str | None = None, touch_links: Any = None) -> None:
        """Attaches an object, by its name or as a message, to a link."""
        model.warn_once(_NOT_AVOIDED)
        from moveit_msgs.msg import AttachedCollisionObject, CollisionObject

        if isinstance(object, str):
            name, object = object, CollisionObject()
            object.id = name
        if not hasattr(object, "link_name"):
            attached = AttachedCollisionObject()
            attached.object = object
        else:
            attached = object
        own = attached.object.id
        attached.object = _world.pop(own, attached.object)
        if link is not None:
            attached.link_name = link
        attached.touch_links = [attached.link_name] if touch_links is None else list(touch_links)
        _attached[own] = attached

    def attach_box(
        self, link: str, name: str, pose: Any = None, size: Sequence[float] = (1, 1, 1), touch_links: Any = None
    ) -> None:
        """Attaches a box that is made, or the object of this name."""
        self.attach_object(name if pose is None else self.make_box(name, pose, size), link, touch_links)

    def attach_sphere(self, link: str, name: str, pose: Any = None, radius: float = 1, touch_links: Any = None) -> None:
        """Attaches a sphere that is made, or the object of this name."""
        self.attach_object(name if pose is None else self.make_sphere(name, pose, radius), link, touch_links)

    def attach_cylinder(
        self, link: str, name: str, pose: Any = None, height: float = 1, radius: float = 1, touch_links: Any = None
    ) -> None:
        """Attaches a cylinder that is made, or the object of this name."""
        self.attach_object(name if pose is None else self.make_cylinder(name, pose, height, radius), link, touch_links)

    def attach_mesh(
        self,
        link: str,
        name: str,
        pose: Any = None,
        filename: str = "",
        size: Sequence[float] = (1, 1, 1),
        touch_links: Any = None,
    ) -> None:
        """Attaches the object of this name; meshes are not read."""
        if pose is not None and filename:
            self.add_mesh(name, pose, filename, size)
        self.attach_object(name, link, touch_links)

    def remove_attached_object(self, link: str | None = None, name: str | None = None) -> None:
        """Detaches an object, all of a link, or all; it stays in the world."""
        for own, attached in list(_attached.items()):
            if link in (None, "", attached.link_name) and name in (None, own):
                _world[own] = _attached.pop(own).object

    # ── what is known ──

    def get_known_object_names(self, with_type: bool = False) -> list[str]:
        """The names of all objects that are not attached."""
        return list(_world)

    def get_known_object_names_in_roi(self, *bounds: Any, **how: Any) -> NoReturn:
        """Refused."""
        raise NotImplementedError(
            "PlanningSceneInterface.get_known_object_names_in_roi is not there in hrdsl: compare the poses of get_object_poses"
        )

    def get_object_poses(self, object_ids: Sequence[str]) -> dict[str, Any]:
        """The poses of objects, by their names."""
        found = {}
        for name in object_ids:
            if name in _world:
                known = _world[name]
                found[name] = known.pose if hasattr(known, "pose") else known.primitive_poses[0]
        return found

    def get_objects(self, object_ids: Sequence[str] = []) -> dict[str, Any]:
        """Objects by their names, or all."""
        return {name: known for name, known in _world.items() if not object_ids or name in object_ids}

    def get_attached_objects(self, object_ids: Sequence[str] = []) -> dict[str, Any]:
        """Attached objects by their names, or all."""
        return {name: known for name, known in _attached.items() if not object_ids or name in object_ids}

    def __getattr__(self, name: str) -> Any:
        if name in ("get_planning_scene", "apply_planning_scene", "make_mesh"):
            raise NotImplementedError("PlanningSceneInterface.%s is not there in hrdsl: add and remove objects one by one" % name)
        raise AttributeError("%r object has no attribute %r" % (type(self).__name__, name))

    # ── messages ──

    @staticmethod
    def make_box(name: str, pose: Any, size: Sequence[float]) -> Any:
        """A box, as a `CollisionObject`."""
        return _make(name, pose, 1, size)

    @staticmethod
    def make_sphere(name: str, pose: Any, radius: float) -> Any:
        """A sphere."""
        return _make(name, pose, 2, [radius])

    @staticmethod
    def make_cylinder(name: str, pose: Any, height: float, radius: float) -> Any:
        """A cylinder."""
        return _make(name, pose, 3, [height, radius])

    @staticmethod
    def make_cone(name: str, pose: Any, height: float, radius: float) -> Any:
        """A cone."""
        return _make(name, pose, 4, [height, radius])

    @staticmethod
    def make_plane(name: str, pose: Any, normal: Sequence[float] = (0, 0, 1), offset: float = 0) -> Any:
        """A plane."""
        from moveit_msgs.msg import CollisionObject
        from shape_msgs.msg import Plane

        made = CollisionObject()
        made.operation = CollisionObject.ADD
        made.id = name
        made.header = pose.header
        plane = Plane()
        plane.coef = [float(number) for number in (*normal, offset)]
        made.planes, made.plane_poses = [plane], [pose.pose]
        return made
