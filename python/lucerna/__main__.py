# SPDX-License-Identifier: Apache-2.0
"""`python -m lucerna` is the program."""
import os
import shutil
import sys
import sysconfig


def main() -> None:
    """Becomes the program `lucerna`: that beside this interpreter, else the first on the path."""
    places = os.pathsep.join([sysconfig.get_path("scripts"), os.path.dirname(sys.executable),
                              os.environ.get("PATH", os.defpath)])
    program = shutil.which("lucerna", path=places)
    if program is None:
        sys.exit("lucerna: the program is not installed (Debian package: lucerna)")
    os.execv(program, [program, *sys.argv[1:]])


if __name__ == "__main__":
    main()
