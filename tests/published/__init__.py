"""Every way in which fingertip is published, in an environment of its own, made by the lines that
users type.

Each way runs the command that it is advertised for, on a valid design and on a broken one. These
tests fetch packages from the index: `.ci/run` runs those of the core, the hook and the action,
`.ci/full` all of them.
"""
