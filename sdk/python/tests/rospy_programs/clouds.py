"""`sensor_msgs.point_cloud2`: clouds of points that are made, and read."""
# departs: `read_points` warns of a field that the cloud does not have
# stderr
import rospy
from sensor_msgs import point_cloud2
from sensor_msgs.msg import PointCloud2, PointField
from std_msgs.msg import Header

header = Header(frame_id="camera")
cloud = point_cloud2.create_cloud_xyz32(header, [(1, 2, 3), (4, 5.5, 6), (float("nan"), 0, 0)])
print(cloud.width, cloud.height, cloud.point_step, cloud.row_step, cloud.is_dense, cloud.is_bigendian, cloud.header.frame_id, len(cloud.data))
print([(each.name, each.offset, each.datatype, each.count) for each in cloud.fields], type(cloud.data).__name__)
print(list(point_cloud2.read_points(cloud)))
print(list(point_cloud2.read_points(cloud, skip_nans=True, field_names=("x", "z"))))
print(list(point_cloud2.read_points(cloud, field_names=["y"], uvs=[(1, 0)])))
print(point_cloud2.read_points_list(cloud, skip_nans=True))
fields = [PointField("x", 0, PointField.FLOAT32, 1), PointField("label", 4, PointField.UINT16, 1), PointField("pair", 8, PointField.INT8, 2)]
other = point_cloud2.create_cloud(header, fields, [(0.5, 7, 1, 2), (1.5, 8, -1, -2)])
print(other.point_step, bytes(other.data).hex())
print(list(point_cloud2.read_points(other)), list(point_cloud2.read_points(other, ["label"])))
print(point_cloud2.read_points_list(other, ["x", "label"])[0]._fields)
for wrong in (lambda: point_cloud2.read_points_list(other), lambda: list(point_cloud2.read_points("cloud")), lambda: point_cloud2.create_cloud_xyz32(header, [(1, 2)]),
              lambda: list(point_cloud2.read_points(cloud, ["w"]))):  # fmt: skip
    try:
        print(wrong())
    except Exception as error:
        print(type(error).__name__, error)
