"""Pictures of the casting steps, and of the finished finger.

In: a design with its casting sheet, and names of steps. Out: PNG by file name.

>>> from fingertip.pictures.steps.scenes import SCENES
>>> list(SCENES)[:4]
['print', 'varnish', 'solder', 'lay_in']
"""
