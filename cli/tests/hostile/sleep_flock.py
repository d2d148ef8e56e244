# Waits for a lock on a file that its child holds, where no simulated time passes.
# expect: error "it slept for 1 s of wall time"
import fcntl, os, posix, time
import hrdsl
node = hrdsl.Node('robot')
one = open('lock', 'w')
fcntl.flock(one, fcntl.LOCK_EX)
if posix.fork() == 0:
    os.execvp('sleep', ['sleep', '1000'])
two = open('lock', 'w')
fcntl.flock(two, fcntl.LOCK_EX)
