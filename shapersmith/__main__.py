"""`python -m shapersmith`, the command `shapersmith`, after the check for clashing names."""

import sys

from service.__main__ import main

if __name__ == "__main__":
    sys.exit(main())
