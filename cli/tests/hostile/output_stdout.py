# Floods standard output.
# expect: error "bytes of output"
import hrdsl
node = hrdsl.Node('robot')
while True:
    print('x' * 1000)
