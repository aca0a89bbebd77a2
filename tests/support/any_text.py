"""Characters of any text, for tests that damage files and entries."""

from hypothesis import strategies as st

# The same that `st.text` takes by itself, all that UTF-8 knows. Asked by the name of the codec hypothesis tries each of
# a million of them, in every process that finds no file with the answer.
ANY = st.characters(exclude_categories=["Cs"])
