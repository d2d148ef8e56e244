"""A lamp that is asked for light, and dims itself by what the daylight is and how long nobody has asked."""

import hrdsl

WARM_UP_TIME = 0.5  # seconds
BRIGHTEST = 100
DARKEST = 5
HALF_LIFE = 40.0


def clamped(value, low, high):
    if value < low:
        return low
    if value > high:
        return high
    return value


def level(asked, daylight, age):
    """How bright it is to be, in percent."""
    wanted = asked - daylight * 0.6
    if age > 3:
        wanted = wanted - (age - 3) * 2
    wear = 1 + age / HALF_LIFE
    return clamped(wanted / wear, DARKEST, BRIGHTEST)


def ramp(start, end, steps):
    """The levels on the way from one to another."""
    levels = []
    for step in range(1, steps + 1):
        levels.append(start + (end - start) * step / steps)
    return levels


class Lamp:
    def __init__(self, node):
        self.node = node
        self.level = 0.0
        self.asked = 0
        self.faults = 0

    def light(self):
        self.asked += 1
        daylight = 10 * (self.asked % 4)
        goal = level(80, daylight, self.asked)
        for step in ramp(self.level, goal, 5):
            if step < 0 or step > BRIGHTEST:
                self.faults += 1
                continue
            self.level = step
        if abs(self.level - goal) > 1 and self.faults == 0:
            self.node.emit("failed")
            return False
        self.node.sleep(WARM_UP_TIME)
        self.node.emit("lit")
        return True


def main():
    lamp = Lamp(hrdsl.Node("robot"))
    while True:
        event = lamp.node.wait_for("asked", timeout=10.0)
        if event is None:
            break
        if not lamp.light() or lamp.faults > 2:
            break


main()
