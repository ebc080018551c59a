"""Studies of the article beside a validation: its protocol, its
board, and what other assumptions change.
"""
