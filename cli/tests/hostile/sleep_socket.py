# Waits for a socket that nobody connects to, where no simulated time passes.
# expect: error "it slept for 1 s of wall time"
import socket
import hrdsl
node = hrdsl.Node('robot')
server = socket.socket()
server.bind(('127.0.0.1', 0))
server.listen()
server.accept()
