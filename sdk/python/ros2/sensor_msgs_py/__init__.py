"""What ROS 2 has for messages of sensors."""
