"""Documents for people, from templates in Markdown: sheets, READMEs and first screens of fingers,
sets and boards.

In: a design, or the data of a sheet. Out: text, laid out in lines. `lab` collects the data of a
validation.

>>> from fingertip.documents.template import render_text
>>> render_text("Post of {{ limits | span }} mm", limits=(8.0, 9.5))
'Post of 8 to 9.5 mm'
"""
