# Binds a port that all others bind, too.
# expect: pass
# needs: namespaces
import socket
import hrdsl
node = hrdsl.Node('robot')
server = socket.socket()
server.bind(('127.0.0.1', 45671))
server.listen()
node.wait_for('asked')
node.emit('said', n=1)
