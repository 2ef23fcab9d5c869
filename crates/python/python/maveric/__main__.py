"""The command ``maveric``."""

import sys

from . import _native


def main() -> None:
    """Run the command with the process's own arguments."""
    sys.exit(_native.run(sys.argv[1:], sys.executable, ["-m", "maveric"]))


if __name__ == "__main__":
    main()
