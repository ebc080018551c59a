"""Page of a design or a set: one HTML file that needs no network.

In: the files in the folder of a design. Out: bytes of HTML, in which whatever is not markup is
escaped.

>>> from fingertip.page.html import element
>>> element("p", "skin < bone", class_="note")
'<p class="note">skin &lt; bone</p>'
"""
