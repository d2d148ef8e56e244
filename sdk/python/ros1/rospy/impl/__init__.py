"""Where some programs look for parts of rospy."""
