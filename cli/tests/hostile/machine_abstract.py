# Binds an abstract name that all others bind, too.
# expect: pass
# needs: namespaces
import socket
import hrdsl
node = hrdsl.Node('robot')
one = socket.socket(socket.AF_UNIX)
one.bind('\0hrdsl-soak')
node.wait_for('asked')
node.emit('said', n=1)
