"""One seal: the problem that a case poses, its loads, contacts and leak rates."""
