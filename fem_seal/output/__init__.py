"""From numbers to files and words: columns, tables, pictures, the report."""
