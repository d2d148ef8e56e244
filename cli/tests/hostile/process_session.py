# Leaves a session of its own that ignores SIGTERM; it answers.
# expect: pass
import os, posix, signal, time
import hrdsl
node = hrdsl.Node('robot')
if posix.fork() == 0:
    os.setsid()
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    if posix.fork() == 0:
        os.execvp('sleep', ['sleep', '1000'])
    os.execvp('sleep', ['sleep', '1000'])
node.wait_for('asked')
node.emit('said', n=1)
