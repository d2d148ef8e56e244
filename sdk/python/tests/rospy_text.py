"""What is kept of the output of a program of ROS 1, so that two runs of it can be compared, and how such a program wants to be run."""

import re
import shlex


class Head:
    """What a program says of itself in the comments under its first line.

    `# arguments:` has the words behind its name, `# environment:` a variable with its value, `# needs:` modules of Python. `# stderr`
    says that standard error is compared, too, and `# code:` with which code it ends, if that is not 0. Each `# departs:` is a
    sentence about what is different in simulated time."""

    def __init__(self, text):
        self.arguments = shlex.split(self._said(text, "arguments"))
        name, _, value = self._said(text, "environment").partition("=")
        self.environment = {name: value} if name else {}
        self.needs = self._said(text, "needs").split()
        self.departs = re.findall(r"^# departs: (.*)$", text, re.M)
        self.code = int(self._said(text, "code") or 0)
        self.has_stderr = re.search(r"^# stderr$", text, re.M) is not None

    def _said(self, text, key):
        found = re.search(r"^# %s: (.*)$" % key, text, re.M)
        return found.group(1) if found else ""


def kept(text, folder):
    """The text without what is another at each run or on each machine: the folder of the program, the date of a line of the
    log, numbers of processes and ports, addresses of objects, and of tracebacks the frames in other files and the marks under
    the statements."""
    text = text.replace(folder.rstrip("/") + "/", "")
    text = re.sub(r"\[\d{10}\.\d{6}\]", "[DATE]", text)
    text = re.sub(r"(?<=pid\[)\d+", "PID", text)
    text = re.sub(r"(?<=127\.0\.0\.1[ :])\d{4,5}", "PORT", text)
    text = re.sub(r"0x[0-9a-f]{6,}", "ADDRESS", text)
    text = re.sub(r"^\['Traceback .*\]$", "[TRACEBACK]", text, flags=re.M)
    lines, is_left_out = [], False
    for line in text.splitlines(keepends=True):
        frame = re.match(r'  File "(.*?)", line \d+', line)
        if frame:
            is_left_out = frame.group(1).startswith(("/", "<"))
        elif not line.startswith("    "):
            is_left_out = False
        if not is_left_out and not re.fullmatch(r"    [ ~^]*\^[ ~^]*\n", line):
            lines.append(line)
    return "".join(lines)
