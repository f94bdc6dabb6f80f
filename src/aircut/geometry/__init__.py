"""Pure geometry on numbers and arrays. Knows nothing of programs or modal state."""
