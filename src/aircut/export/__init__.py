"""What can be made of a recording: pictures to look at, and files for other programs."""
