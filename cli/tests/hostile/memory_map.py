# Maps memory until there is none.
# expect: error "Cannot allocate memory"
import mmap
import hrdsl
node = hrdsl.Node('robot')
maps = []
while True:
    maps.append(mmap.mmap(-1, 64 << 20, mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS))
