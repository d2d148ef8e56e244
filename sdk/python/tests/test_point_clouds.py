"""Clouds of points, under both clients."""

import importlib.util
import unittest

from ros2_programs import Ros2Case
from tables import run_ros


class Clouds(Ros2Case):
    def test_of_ros1(self):
        text = """
            import math, rospy, io
            from sensor_msgs import point_cloud2
            from sensor_msgs.msg import PointCloud2, PointField
            from std_msgs.msg import Header
            rospy.init_node("node")
            cloud = point_cloud2.create_cloud_xyz32(Header(frame_id="map"), [(1, 2, 3), (4, math.nan, 6), (7, 8, 9)])
            print(cloud.width, cloud.height, cloud.point_step, cloud.row_step, len(cloud.data), [f.name for f in cloud.fields])
            print(list(point_cloud2.read_points(cloud, skip_nans=True)))
            print(list(point_cloud2.read_points(cloud, ("x", "z"), uvs=[(2, 0), (0, 0)])))
            print(point_cloud2.read_points_list(cloud, ["z"], True))
            odd = [PointField("id", 0, PointField.UINT16, 1), PointField("pair", 4, PointField.FLOAT64, 2)]
            made = point_cloud2.create_cloud(Header(), odd, [(1, 0.5, 1.5), [2, 2.5, 3.5]])
            print(made.point_step, list(point_cloud2.read_points(made)))
            file = io.BytesIO()
            made.serialize(file)
            print(list(point_cloud2.read_points(PointCloud2().deserialize(file.getvalue()), ["pair", "no"])))
            print(point_cloud2.create_cloud(Header(), odd, []).point_step)
            odd[0].datatype = 9
            try:
                list(point_cloud2.read_points(made))
            except ValueError as error:
                print(error)
            """
        finished = run_ros(text, ("sensor_msgs", "std_msgs"))
        self.assertEqual(
            finished.out.splitlines(),
            [
                "3 1 12 36 36 ['x', 'y', 'z']",
                "[(1.0, 2.0, 3.0), (7.0, 8.0, 9.0)]",
                "[(7.0, 9.0), (1.0, 3.0)]",
                "[Point(z=3.0), Point(z=6.0), Point(z=9.0)]",
                "20 [(1, 0.5, 1.5), (2, 2.5, 3.5)]",
                "[(0.5, 1.5), (2.5, 3.5)]",
                "20",
                "field id of the cloud is of the unknown type 9",
            ],
        )
        self.assertEqual(finished.err, "[WARN] [1735689600.000000]: the cloud has no field no: it has id, pair\n")

    @unittest.skipUnless(importlib.util.find_spec("numpy"), "NumPy is not installed")
    def test_of_ros2(self):
        text = """
import math, numpy as np
from sensor_msgs_py import point_cloud2
from sensor_msgs.msg import PointCloud2, PointField
from std_msgs.msg import Header
cloud = point_cloud2.create_cloud_xyz32(Header(frame_id="map"), [(1, 2, 3), (4, math.nan, 6), (7, 8, 9)])
print(cloud.width, cloud.height, cloud.point_step, cloud.row_step, len(cloud.data), [f.name for f in cloud.fields])
print(point_cloud2.read_points(cloud, skip_nans=True).tolist())
print(point_cloud2.read_points(cloud, ["x", "z"], uvs=[(2, 0), (0, 0)]).tolist())
print(point_cloud2.read_points_numpy(cloud, ["z", "x"], uvs=np.array([1])).tolist())
print([float(point.z) for point in point_cloud2.read_points_list(cloud, ["z"], True)])
odd = [PointField(name="id", offset=0, datatype=PointField.UINT16, count=1),
       PointField(name="pair", offset=4, datatype=PointField.FLOAT64, count=2)]
made = point_cloud2.create_cloud(Header(), odd, [(1, 0.5, 1.5), [2, 2.5, 3.5]])
print(made.point_step, point_cloud2.read_points(made).tolist(), point_cloud2.read_points(made).dtype.names)
again = point_cloud2.create_cloud(Header(), odd, point_cloud2.read_points(made))
print(again == made, point_cloud2.create_cloud(Header(), odd, []).width)
grid = point_cloud2.create_cloud_xyz32(Header(), np.zeros((2, 4, 3)))
print(grid.height, grid.width, grid.row_step)
for call in (
    lambda: point_cloud2.read_points(cloud, ["w"]),
    lambda: point_cloud2.read_points_numpy(made),
    lambda: point_cloud2.create_cloud(Header(), odd, [(1, 2)]),
):
    try:
        call()
    except AssertionError as error:
        print(error)
"""
        out = [
            "3 1 12 36 36 ['x', 'y', 'z']",
            "[(1.0, 2.0, 3.0), (7.0, 8.0, 9.0)]",
            "[(7.0, 9.0), (1.0, 3.0)]",
            "[[6.0, 4.0]]",
            "[3.0, 6.0, 9.0]",
            "20 [(1, 0.5, 1.5), (2, 2.5, 3.5)] ('id', 'pair_0', 'pair_1')",
            "True 0",
            "2 4 48",
            "the cloud has no field w",
            "All fields need to have the same datatype. Use `read_points()` otherwise.",
            "a point has 2 values, and the fields 3",
        ]
        self.assertEqual(self.said(text), out)


if __name__ == "__main__":
    unittest.main()
