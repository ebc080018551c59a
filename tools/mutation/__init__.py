"""Mutation testing: changes in the source, one at a time, that the tests must notice.

`changes.py` draws them over all lines of src with cosmic-ray, by the Python it is installed in.
`reach.py` records which tests enter which blocks of the source, and `run.py` runs these tests on
each changed module. `equivalent.toml` lists the changes that no test can notice, each with its
reason. On one of two busy cores, the record of the first set takes eleven minutes, and a sample of
40 changes with a seed of its own eight.
"""
