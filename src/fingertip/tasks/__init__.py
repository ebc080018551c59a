"""Tasks of the command line and of Python, which each make one set of files.

A design and a folder come in; the folder holds either the old files or all new ones, and the paths
go out.

>>> from fingertip import Design
>>> from fingertip.tasks.build import BuildOptions, plan_build
>>> plan_build(Design(), "out/mine", BuildOptions(formats=["stl"])).formats
('stl',)
"""
