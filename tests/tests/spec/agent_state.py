"""What the state of an agent consists of, as `spec/agents-semantics.md` defines it."""

from agent_values import OPEN


class Failed(Exception):
    """A step that fails, with the cause."""


class Fact:
    def __init__(self, values):
        self.values, self.annotations = values, []

    def sources(self):
        return [value for name, value in self.annotations if name == "source"]


class Event:
    """What is to be deliberated on, and the intention, or the question, that waits for it."""

    def __init__(self, on, values, annotations, i=None, question=None, timer=None):
        self.on, self.values, self.annotations = on, values, annotations
        self.i, self.question, self.timer = i, question, timer


class Block:
    """A list of steps that is being done, and the place in it."""

    def __init__(self, steps, loop=None, saved=None, left=()):
        self.steps, self.place = steps, 0
        self.loop, self.saved, self.left = loop, saved, list(left)

    def is_over(self):
        return self.place == len(self.steps) and self.loop != "while" and not self.left


class Frame:
    def __init__(self, plan, event, theta, steps=None):
        self.plan, self.theta, self.is_branch = plan, theta, steps is not None
        self.on, self.values, self.annotations = event.on, event.values, event.annotations
        self.blocks = [Block(plan["body"] if steps is None else steps)]
        self.at, self.timer = None, None

    def kind(self):
        return "branch" if self.is_branch else next(iter(self.on))

    def is_of(self, goal):
        return self.kind() in ("goal_added", "goal_failed") and next(iter(self.on.values())) == goal

    def wants(self):
        """Whether it is of a goal that was open somewhere."""
        return self.kind().startswith("goal") and any(v is OPEN for v in self.values)

    def is_finished(self):
        return all(block.is_over() for block in self.blocks)

    def advance(self):
        """To the next step; false if there is none."""
        while self.blocks:
            block = self.blocks[-1]
            if block.place < len(block.steps):
                return True
            if block.left:
                self.theta, block.place = block.left.pop(0), 0
                continue
            self.blocks.pop()
            if block.loop:
                self.theta = block.saved
            if block.loop == "while":
                self.blocks[-1].place -= 1
        return False

    def next(self):
        block = self.blocks[-1]
        self.at = block.steps[block.place]
        block.place += 1
        return self.at


class Intention:
    def __init__(self, number):
        self.number, self.frames = number, []
        self.group = None  # of which it is a branch
        self.fork = None  # the group that it waits for
        self.doing = None  # the action that it waits for
        self.question = None  # to be answered when it is finished
        self.suspended = self.held = False
        self.alive, self.touched = True, False

    def is_atomic(self):
        return any(f.plan["atomic"] for f in self.frames) or bool(self.group and self.group.parent.is_atomic())

    def family(self):
        yield self
        for branch in self.fork.members if self.fork else []:
            yield from branch.family()


class Group:
    def __init__(self, parent, every):
        self.parent, self.every, self.members = parent, every, []


class Timer:
    def __init__(self, due, serial, i, sort):
        self.due, self.serial, self.i, self.sort, self.frame = due, serial, i, sort, None


class Message:
    def __init__(self, sender, what, content=None, values=(), request=None, annotations=()):
        self.sender, self.what, self.content, self.values, self.request = sender, what, content, values, request
        self.annotations = list(annotations)


def failed_of(on):
    """The trigger for the failure of a goal or a test goal; None for others."""
    ((sort, number),) = on.items()
    return {sort.replace("added", "failed"): number} if sort in ("goal_added", "test_added") else None
