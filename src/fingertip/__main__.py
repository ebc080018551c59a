"""`python -m fingertip` is the `fingertip` command."""

from fingertip.cli import main

if __name__ == "__main__":
    main()
