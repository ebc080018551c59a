"""Studio: a local page with a form of parameters, where parts follow each change.

In: the values of the form, with each change. Out: parts, figures and checks for the page, and files
to save.

>>> from fingertip.studio.form_page import make_form
>>> len(make_form()["sensor"])  # fields of that table
5
"""
