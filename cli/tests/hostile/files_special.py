# Makes pipes and sockets in its folder; it answers.
# expect: pass
# options: --keep-files
import os, socket
import hrdsl
node = hrdsl.Node('robot')
os.mkfifo('pipe')
socket.socket(socket.AF_UNIX).bind('socket')
node.wait_for('asked')
node.emit('said', n=1)
