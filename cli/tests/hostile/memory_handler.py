# Catches that memory is used up, for ever.
# expect: error "within 1 s of processor time"
import hrdsl
node = hrdsl.Node('robot')
many = []
while True:
    try:
        many.append(bytearray(1 << 24))
    except MemoryError:
        pass
