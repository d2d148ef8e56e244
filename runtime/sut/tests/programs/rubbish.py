import os
import sys

fd = int(os.environ["HRDSL_REQUEST_FD"])
if sys.argv[1] == "short":
    os.write(fd, b"Traceback: this is no request\n")
else:
    while True:
        os.write(fd, b"x" * 65536)
