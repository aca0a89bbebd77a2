"""Results as files and words: columns, tables, pictures, report."""
