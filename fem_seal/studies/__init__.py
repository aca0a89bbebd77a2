"""Design studies: one case turned into many, evaluated in parallel, kept in one file, judged in one page.

Which points (`designs`, `parameters`), how they run (`execute`, `evaluate`, `store`) and what they mean
(`analysis`, `sensitivity`, `page`) do not know each other; `study` holds what all three need.
"""
