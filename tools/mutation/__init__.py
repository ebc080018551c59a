"""Mutation testing: changes in the source, one at a time, that the tests of a module must notice.

cosmic-ray finds what can be changed (`tools/mutation/changes.py`, run by the Python it is installed in), and
`python -m tools.mutation.run` runs the tests on each changed module. `modules.toml` names modules and their tests,
`equivalent.toml` the changes that no test can notice, each with its reason.
"""
