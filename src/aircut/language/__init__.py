"""From a line of text to what it says: words, expressions, blocks, marks. Runs nothing."""
