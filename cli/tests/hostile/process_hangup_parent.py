# Sends its parent every signal but those that stop or kill.
# expect: any
# needs: namespaces
import os, signal
import hrdsl
node = hrdsl.Node('robot')
for number in range(1, 65):
    if number not in (signal.SIGKILL, signal.SIGSTOP, 32, 33):
        try:
            os.kill(os.getppid(), number)
        except OSError:
            pass
node.wait_for('asked')
node.emit('said', n=1)
