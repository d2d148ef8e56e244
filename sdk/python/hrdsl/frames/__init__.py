"""Where frames are to each other: what `tf` and `tf2_ros` are made of, under both clients."""
