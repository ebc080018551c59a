"""Byte manifest: SHA-256 of every file of the default designs and of pcb/, for stated versions of
the packages.

`python -m tools.manifest.write` renews it after a deliberate change of the outputs;
`python -m tools.manifest.compare` compares it with what this machine makes.
"""
