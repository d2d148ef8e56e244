"""`python -m hrdsl.run [options] script.py args...`: see `hrdsl.runner`."""

import sys

if __name__ == "__main__":
    if not __package__:  # started by its path, which spares the interpreter a search
        sys.path[0] = __file__.rsplit("hrdsl", 1)[0] or "."
    from hrdsl.runner import main

    main(sys.argv[1:])
