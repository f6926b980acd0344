"""The command ``gapath``, started without collecting what lives as long as the process."""

import gc
import sys


def main() -> None:
    """Run the command `gapath.commands.run.main`.

    Modules are some hundred thousand objects, none of them garbage. To look for garbage among
    them again and again takes an eighth of a short command's time.
    """
    gc.disable()
    try:
        from gapath.commands.run import main as command
    except KeyboardInterrupt:
        sys.exit(130)
    gc.freeze()
    gc.enable()
    command()


if __name__ == "__main__":
    main()
