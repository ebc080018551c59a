import pytest

pytest.register_assert_rewrite("tests.approved")  # a difference from an approved text is shown
