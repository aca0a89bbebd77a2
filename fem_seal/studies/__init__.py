"""One case turned into many: designs, evaluated in parallel, kept in one file, judged in one page."""
