import rospy
from no_such_msgs.msg import Thing
