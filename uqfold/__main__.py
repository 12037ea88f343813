"""``python -m uqfold`` is the command ``uqfold``."""

from uqfold.cli import main

if __name__ == "__main__":
    main()
