"""How fast, and which way: from a pose and a scan to a velocity. Lengths in metres, angles in radians."""

import math

MIN_SPEED = 0.05  # m/s, of the wheels


def clamp(value, low, high):
    """The value, or the nearer limit."""
    return max(low, min(high, value))


def wrap(angle):
    """The same angle, from -pi to pi."""
    return math.atan2(math.sin(angle), math.cos(angle))


def clearance(scan, half_width):
    """How far it is from the scanner to the first thing in the strip that the base will go through."""
    nearest = scan.range_max
    for index, distance in enumerate(scan.ranges):
        if not scan.range_min <= distance <= scan.range_max:
            continue  # nothing there, or no valid reading
        angle = scan.angle_min + index * scan.angle_increment
        ahead = distance * math.cos(angle)
        beside = distance * math.sin(angle)
        if ahead > 0.0 and abs(beside) <= half_width:
            nearest = min(nearest, ahead)
    return nearest


def allowed_speed(distance, stop_distance, slow_distance, max_speed):
    """Full speed if it is free for the slow distance, none within the stop distance, and in between what is in between.

    Slower than `MIN_SPEED` is as good as none.
    """
    part = (distance - stop_distance) / (slow_distance - stop_distance)
    speed = max_speed * clamp(part, 0.0, 1.0)
    return speed if speed >= MIN_SPEED else 0.0


def steer(pose, target, limits):
    """Forward speed and turn rate towards a place: turns on the spot until it lies ahead, and then goes.

    `pose` is x, y and heading, `target` x and y, `limits` the greatest speed and turn rate.
    """
    x, y, heading = pose
    max_speed, max_turn = limits
    dx, dy = target[0] - x, target[1] - y
    error = wrap(math.atan2(dy, dx) - heading)
    turn = clamp(2.0 * error, -max_turn, max_turn)
    if abs(error) > 0.35:
        return 0.0, turn
    return clamp(0.8 * math.hypot(dx, dy), MIN_SPEED, max_speed), turn
