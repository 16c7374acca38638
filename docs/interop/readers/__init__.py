"""One module a program; each has `read(path)`, which gives its version and a list of parts (see `part.py`)."""
